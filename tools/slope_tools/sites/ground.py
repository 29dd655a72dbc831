"""The ground of a run, by the values of its deck's variables."""

SEED = "ground_seed"        # variable of a deck whose ground is scattered balls; without it, it is a plan grid
SCALED = "${d}"             # field_d of a deck whose ground scales with its balls
