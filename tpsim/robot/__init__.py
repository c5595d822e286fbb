"""Robots: intake of MJCF and URDF, kinematics and dynamics, states and views."""
