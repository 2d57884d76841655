"""Kitchens and robots, before any question of motion."""
