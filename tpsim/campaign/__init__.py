"""Campaigns: thousands of perturbed trials as a value, performed anywhere, resumed, compared."""
