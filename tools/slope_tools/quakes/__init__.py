"""Records of earthquakes, and the ground motion that is made of them."""
