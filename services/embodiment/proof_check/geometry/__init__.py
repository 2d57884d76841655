"""Intervals rounded outwards, and in them kinematics and shapes of a twin: all that a check computes with."""
