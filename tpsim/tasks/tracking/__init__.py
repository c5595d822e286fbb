"""Tracking two moving objects with two hands that share a trunk (Section 7, Fig. 11)."""
