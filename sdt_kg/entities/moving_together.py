"""Joints that move together, as triples about one of them: derived, and in no graph of a twin."""

from collections.abc import Iterator
from typing import Final

import numpy as np
import pyoxigraph as ox

from sdt_kg.entities.coupling import Coupling
from sdt_kg.iri import SDT, Iri, joint_iri
from sdt_kg.mechanism import Joint, JointType, Mechanism
from sdt_kg.store import Triple

MOVES_WITH, HANGS_ON, FOLDS_ON = SDT + "movesWith", SDT + "hangsOn", SDT + "foldsOn"

PARALLEL: Final = 1e-9
"""[1] Largest component of an axis across another that counts as parallel: rounding of a model's figures."""


def moving_together(mechanism: Mechanism, joint: Iri) -> Iterator[Triple]:
    """Which joints move with this one, which of all these hang on another of them, and fold on it."""
    others = Coupling.of(mechanism).together(joint)
    if not others:
        return
    above = {each.child: each for each in mechanism.joints}
    together = {joint, *others}
    for other in sorted(others):
        yield joint, MOVES_WITH, ox.NamedNode(other)
    for each in mechanism.joints:
        one, body, axis = joint_iri(mechanism.name, each.name), each.parent, _in_parent(each, each.axis)
        folds = each.type is JointType.REVOLUTE
        while one in together and body in above:
            carrier = above[body]
            upper = joint_iri(mechanism.name, carrier.name)
            if upper in together:
                folds &= carrier.type is JointType.REVOLUTE and _parallel(axis, carrier.axis)
                yield one, HANGS_ON, ox.NamedNode(upper)
                if folds:
                    yield one, FOLDS_ON, ox.NamedNode(upper)
            else:
                folds &= carrier.type is JointType.FIXED
            axis, body = _in_parent(carrier, axis), carrier.parent


Vector = tuple[float, float, float]


def _in_parent(joint: Joint, vector: Vector) -> Vector:
    """A direction of a joint's frame, all joints being at 0, in the frame of the body that carries it."""
    x, y, z = (joint.origin.matrix()[:3, :3] @ np.array(vector)).tolist()
    return x, y, z


def _parallel(one: Vector, other: Vector) -> bool:
    return bool(np.abs(np.cross(one, other)).max() <= PARALLEL)
