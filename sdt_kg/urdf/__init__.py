"""URDF (or xacro) → Mechanism.

`read_mechanism` is the way in. Collision geometry only: nothing that is judged rests on visuals.
"""

from sdt_kg.urdf.read import read_mechanism

__all__ = ["read_mechanism"]
