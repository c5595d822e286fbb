"""Panels of the page: buttons and sliders, each for one thing that people do."""
