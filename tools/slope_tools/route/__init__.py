"""Many slopes beside one road: the bodies along a corridor, the runs of all, and what they say of the road together."""
