"""Runs of drawn parameters, as given or weighted by known events."""
