"""Coordinates y(q) that frames observe: poses, directions, and what is left free beneath them."""
