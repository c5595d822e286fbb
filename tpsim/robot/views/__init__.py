"""Views: quantities y(q, objects) with their Jacobians, for learning, control and measuring."""
