"""Grasps of a handle, and whole-body paths that keep it in hand."""
