"""The 3-D view and the film."""
