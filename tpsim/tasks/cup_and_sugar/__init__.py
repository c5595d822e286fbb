"""The tutorial's bimanual example (Section 6, Fig. 9): cup, sugar, and both at once."""
