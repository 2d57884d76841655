"""URDF (or xacro) → Mechanism.

`read_mechanism` is the way in. Collision geometry only: nothing that is judged rests on visuals.
"""

from sdt_kg.urdf.document import parse_xml
from sdt_kg.urdf.read import model_stem, quaternion, read_mechanism

__all__ = ["model_stem", "parse_xml", "quaternion", "read_mechanism"]
