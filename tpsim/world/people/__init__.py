"""People: who pushes, leads and teaches the robot, and how their hands move."""
