"""Policies: what was learned, in a folder that drives a real arm without a simulator."""
