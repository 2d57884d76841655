"""Boxes that lie inside the robot's bodies."""
