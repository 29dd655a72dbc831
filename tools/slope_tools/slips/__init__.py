"""Bodies above slip surfaces: their columns, factor of safety, yield coefficient, displacement in an earthquake."""
