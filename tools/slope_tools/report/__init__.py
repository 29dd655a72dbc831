"""The page on a study or a run."""
