"""Scenes: parts that MjSpec puts together, light, cameras."""
