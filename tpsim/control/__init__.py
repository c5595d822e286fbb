"""From precision to feedback: optimal control and projections (tutorial Sections 6, 7)."""
