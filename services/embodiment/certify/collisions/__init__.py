"""Collisions of a body motion: which pairs keep which distance, what begins inside, how deep they are."""
