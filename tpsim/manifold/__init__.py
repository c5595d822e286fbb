"""Manifolds as values: R^n, S1, S2, S3 and their products, and Gaussians on them."""
