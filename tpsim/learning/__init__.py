"""Mixture models of demonstrations: TP-GMM and its relatives (tutorial Sections 3, 4, 8)."""
