"""MJCF and SDF scenes → Mechanism, like a URDF's; what cannot be carried over is a note.

`read_scene` is the way in.
"""

from sdt_kg.scenes.read import SCENE_SUFFIXES, read_scene, scene_stem

__all__ = ["SCENE_SUFFIXES", "read_scene", "scene_stem"]
