"""Tasks: what is taught, learned and performed, as values that a user makes."""
