"""Studies: what is asked for, its runs, its results."""
