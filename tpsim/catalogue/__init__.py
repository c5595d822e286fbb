"""Robots that are at hand: ours, those of installed packages, and MuJoCo Menagerie's."""
