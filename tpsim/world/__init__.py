"""The plant and all around it: simulation, objects, people, roll-outs, teaching."""
