"""Controllers: what was learned as torque, and what to compare it with."""
