"""The disordered packing of create_balls fill, in which the balls of a body begin: how many, how large, how heavy."""
import math

SOLID = 0.60                        # solid fraction
BULK = 1 / SOLID                    # volume of the ground / volume of its balls; density of a ball / that of the ground
FILLED = SOLID * 6 / math.pi        # balls in a cube of their diameter


def count_balls(volume: float, diameter: float) -> float:
    """The balls of a diameter (m) that fill a volume (m3)."""
    return FILLED * volume / diameter ** 3


def compute_diameter(volume: float, balls: float) -> float:
    """The diameter (m) of so many balls that fill a volume (m3)."""
    return (FILLED * volume / balls) ** (1 / 3)
