"""Movements from models: regression, trajectory models, primitives (tutorial Sections 5, 8)."""
