"""Several runs of one deck: planning, running, statistics."""
