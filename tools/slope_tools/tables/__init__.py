"""The rows of a study, and what is said of them."""
