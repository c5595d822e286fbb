"""Carry from one dock into another along a learned approach (Figs 1, 2, 12)."""
