"""From an earthquake to failures, and to a volume on the road."""
