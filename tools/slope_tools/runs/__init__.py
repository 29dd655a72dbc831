"""Runs of a deck: started, shown, found finished, on this machine or a cluster."""
