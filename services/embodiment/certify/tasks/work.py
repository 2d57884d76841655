r"""Mechanical work of a body motion: J of Π, as far as the robot's model gives masses.

:math:`W = \int \sum_j |\tau_j \dot q_j|\,dt` over joints and base, with :math:`\tau` from inverse dynamics:
inertia and gravity of the robot's bodies. A base's ways along x and y are one, whichever way the kitchen's
axes look: what turns its velocity does no work. Without friction, motors, and what the container resists
with. What a joint gives back is not credited. By quadrature: |·| has kinks.
"""

import numpy as np
import pinocchio as pin  # pyright: ignore[reportMissingImports]  # found through a .pth file

from predicates.specification.quality import unweighed
from sdt_kg.motion import BodyMotion
from services.embodiment.certify.motion import whole_motion
from services.embodiment.certify.tolerances import Tolerances
from services.physics.model import Scene
from services.physics.placements import part_of

NODES = 8
"""[1] Of the Gauss rule on each piece of the motion."""


def mechanical_work(scene: Scene, motion: BodyMotion) -> float | None:
    """[J] Work of joints and base.

    Bodies without mass count as 0 (`predicates.specification.quality.unweighed` names them). None where
    one of these is of the base, or all that has a shape of what a joint moves as one.
    """
    unknown = {*unweighed(scene.robot.mechanism)}
    if any(_weighs_nothing(group, unknown, scene) for group in _rigid(scene)):
        return None
    pieces, _ = whole_motion(scene, motion, Tolerances())
    nodes, weights = np.polynomial.legendre.leggauss(NODES)
    count = len(pieces.start)
    which = np.repeat(np.arange(count), NODES)
    share = np.tile((nodes + 1) / 2, count)
    q, v, a = pieces.at(which, share * pieces.duration[which])
    first = int(scene.base[0])  # of the base and what it carries, on which nothing of the kitchen hangs
    model = part_of(scene.model, range(first + 1, scene.model.njoints))
    q, v, a, data = q[:, first:], v[:, first:], a[:, first:], pin.Data(model)
    powers = np.empty(len(which))
    for n in range(len(which)):
        torques = pin.rnea(model, data, q[n], v[n], a[n])
        powers[n] = np.abs(torques[2:] * v[n, 2:]).sum() + abs(torques[:2] @ v[n, :2])
    return float((powers * np.tile(weights / 2, count) * pieces.duration[which]).sum())


def _rigid(scene: Scene) -> list[set[str]]:
    """Bodies that are rigid with one another."""
    found = dict[int, set[str]]()
    for name, (joint, _) in scene.robot.attached.items():
        found.setdefault(joint, set()).add(name)
    return list(found.values())


def _weighs_nothing(group: set[str], unknown: set[str], scene: Scene) -> bool:
    """Whether a part of the base, or all that has a shape of what else moves as one, has no known mass."""
    if scene.annotation.base_body in group:
        return bool(group & unknown)
    shaped = {each.name for each in scene.robot.mechanism.bodies if each.collision}
    return bool(group & unknown) and group & shaped <= unknown
