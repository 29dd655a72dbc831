"""The colours of quantities: one palette for each in all pictures, safe for the colour-blind (one hue, or viridis)."""
THICKNESS = "YlOrBr"        # of a deposit, and of what is to be removed
DEPTH = "PuBu"              # of a body, a scar, a slip surface
SPEED = "viridis_r"
ARRIVAL = "YlGnBu"
ENERGY = "Purples"
PRESSURE = "Reds"
SHARE = "RdPu"              # of runs, or of known events
HEIGHT = "cividis"          # of balls at the release
SAFETY = "RdYlBu"           # a factor of safety: red below 1
DENSITY = "Blues"           # of a probability
PATH = "plasma_r"           # of a share along a line, whose pale end must be seen on the relief

BY_RASTER = {"thickness": THICKNESS, "max_thickness": THICKNESS, "max_speed": SPEED, "arrival": ARRIVAL,
             "max_energy": ENERGY}      # of fix deposit/grid
