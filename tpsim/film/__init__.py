"""Films: clips of recorded trials, drawn after the simulation."""
