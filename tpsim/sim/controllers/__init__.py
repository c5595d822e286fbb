"""Torque controllers: one law, and where its reference, stiffness and damping come from."""
