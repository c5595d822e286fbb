"""The simulated laboratory: scenes, robots, teaching, pushes and roll-outs."""
