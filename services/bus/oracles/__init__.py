"""Φ and CanPerform as services of their own on the bus."""
