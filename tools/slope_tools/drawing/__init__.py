"""How pictures look: styles, maps on a shaded relief."""
