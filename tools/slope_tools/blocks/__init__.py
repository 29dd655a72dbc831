"""Single blocks, as commands use them: see README.md."""
