"""Pointing at two objects in turn, and back to rest (Section 7, Fig. 10)."""
