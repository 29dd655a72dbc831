"""What a run left: volumes, run-out, agreement with what was observed."""
