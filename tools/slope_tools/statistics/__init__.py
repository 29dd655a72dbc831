"""Distributions, designs, emulators, bands and rules, without files."""
