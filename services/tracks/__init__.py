"""Observed tracks from files: text, .npz, ROS 2 bags."""

from services.tracks.read import read_track

__all__ = ["read_track"]
