"""The tasks that are taught, learned and reproduced."""
