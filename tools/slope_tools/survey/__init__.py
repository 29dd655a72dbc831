"""Terrain, polygons, records of earthquakes and bodies that are released: what a survey gives."""
