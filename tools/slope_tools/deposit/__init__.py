"""What a run left: volumes, travel, comparison with a mapped deposit."""
