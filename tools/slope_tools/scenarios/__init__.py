"""The scenarios of a site side by side."""
