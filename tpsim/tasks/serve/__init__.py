"""Serve: a cup is taken, sugared, poured out into a bowl and put back (a whole scene, K > 1)."""
