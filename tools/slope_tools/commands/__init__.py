"""The subcommands of tools/slope: each parses its arguments, calls the rooms and prints."""
