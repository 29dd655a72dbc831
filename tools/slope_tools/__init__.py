"""The subcommands of tools/slope and what they share."""
