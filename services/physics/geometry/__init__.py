"""Collision shapes: of geometry as coal shapes, meshes in convex pieces, the floor, sampled contacts."""
