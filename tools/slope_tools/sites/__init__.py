"""The folder of a site: choices, layers, deck, size of the balls."""
