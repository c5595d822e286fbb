"""Speeds, measured by ``tpsim bench``."""
