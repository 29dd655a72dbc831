"""Parameters from an observed event."""
