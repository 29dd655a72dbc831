"""Claims and their checks, other codes, speed."""
