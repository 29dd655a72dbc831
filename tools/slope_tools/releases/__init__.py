"""The body that is released, and its files."""
