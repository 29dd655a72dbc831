"""Decks, what they read, and what their runs wrote."""
