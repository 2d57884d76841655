"""Random cabinets with a drawer or pivot door and boxes in its way, and a look at them by code of its own.

Φ lets a container move in what is drawn beside it as its rails, its hinge or what it is fitted into. Here is
asked what it must not let through: the container 20 mm from its sides, or 0.1 m from its hinge, looked at
60 times on its way as boxes of coal, with poses worked out from the drawing, not from the twin.
"""

from dataclasses import dataclass
from pathlib import Path
from typing import Final

import coal
import numpy as np
import pinocchio as pin
from numpy.typing import NDArray

from sdt_kg.iri import joint_iri
from sdt_kg.load import load_twin
from services.physics.oracle import Kinematics
from services.physics.stops.path import Block

Array = NDArray[np.float64]

RAILS: Final = 0.022  # [m] beside which a drawer is looked at: 2 mm more than Φ lets it slide in
HINGE: Final = 0.105  # [m] likewise from a hinge
RUNNERS: Final = 0.052  # [m] likewise in what it is drawn into by more than FITTED
FITTED: Final = 0.003  # [m]
LOOKS: Final = 60
LEAST: Final = 0.002  # [m] thickness of what is looked at
BEYOND: Final = 0.006  # [m] more than is allowed: Φ stops at the first step at which it is too deep
ALLOWED: Final = 0.01  # [m] whatever was drawn
SIZES: Final = 0.02, 0.05, 0.1, 0.3, 0.5  # [m] of boxes in the way
WHERE: Final = "cabinet", "beside", "elsewhere"
"""On which link a box is drawn: that of the joint, one fixed to it, one fixed to the world."""


@dataclass(frozen=True)
class Box:
    """A box turned about the vertical, in the frame of the joint before that is turned."""

    centre: Array
    size: Array
    yaw: float = 0.0
    on: str = "cabinet"

    def pose(self) -> pin.SE3:
        return pin.SE3(pin.rpy.rpyToMatrix(0.0, 0.0, self.yaw), self.centre)


@dataclass(frozen=True)
class Cabinet:
    """What moves, about z (`hinged`) or along x, to `upper`, all of it turned by `yaw`, and what is there."""

    hinged: bool
    upper: float
    yaw: float
    own: tuple[Box, ...]
    others: tuple[Box, ...]

    def urdf(self) -> str:
        axis = (0.0, 0.0, 1.0) if self.hinged else (np.cos(self.yaw), np.sin(self.yaw), 0.0)
        kind = "revolute" if self.hinged else "prismatic"
        links = "".join(
            f'<link name="{name}">{"".join(map(self._shape, shapes))}</link>'
            for name, shapes in (
                *((each, [one for one in self.others if one.on == each]) for each in WHERE),
                ("drawer", self.own),
            )
        )
        fixed = "".join(
            f'<joint name="{child}_joint" type="fixed"><parent link="{parent}"/>'
            f'<child link="{child}"/></joint>'
            for parent, child in (
                ("stand", "cabinet"),
                ("cabinet", "beside"),
                ("world", "elsewhere"),
                ("drawer", "bar_handle"),
            )
        )
        return (
            '<robot name="random"><link name="world"/><link name="stand"/><link name="bar_handle"/>'
            f"{links}{fixed}"
            '<joint name="stand_joint" type="fixed"><parent link="world"/><child link="stand"/></joint>'
            f'<joint name="drawer_joint" type="{kind}"><parent link="cabinet"/><child link="drawer"/>'
            f'<axis xyz="{axis[0]} {axis[1]} {axis[2]}"/>'
            f'<limit lower="0" upper="{self.upper}" velocity="1" effort="9"/></joint></robot>'
        )

    def _shape(self, box: Box) -> str:
        turned = pin.SE3(pin.rpy.rpyToMatrix(0.0, 0.0, self.yaw), np.array((0.0, 0.0, 2.0))) * box.pose()
        (x, y, z), (a, b, c) = turned.translation, box.size
        origin = f'<origin xyz="{x} {y} {z}" rpy="0 0 {self.yaw + box.yaw}"/>'
        return f'<collision>{origin}<geometry><box size="{a} {b} {c}"/></geometry></collision>'

    def at(self, position: float) -> pin.SE3:
        """Where the joint is at a position."""
        turn = position if self.hinged else 0.0
        slid = np.array((0.0 if self.hinged else position, 0.0, 0.0))
        return pin.SE3(pin.rpy.rpyToMatrix(0.0, 0.0, turn), slid)


def random_cabinet(seed: int) -> Cabinet:
    """The same for the same seed."""
    rng = np.random.default_rng(seed)
    hinged, yaw = rng.random() < 0.5, float(rng.uniform(-3, 3)) if rng.random() < 0.5 else 0.0
    own = _door(rng) if hinged else _drawer(rng)
    others = tuple(_in_the_way(rng) for _ in range(rng.integers(1, 4)))
    return Cabinet(hinged, 1.5 if hinged else 0.35, yaw, own, others)


def _door(rng: np.random.Generator) -> tuple[Box, ...]:
    """A panel that turns about an axis through it, some with a box behind it."""
    short, long = rng.uniform(0.0, 0.4), rng.uniform(0.3, 0.6)
    panel = Box(np.array((0.0, (short - long) / 2, 0.0)), np.array((0.02, long + short, 0.5)))
    behind = Box(np.array((-0.05, -long / 2, 0.0)), np.array((0.1, 0.6 * long, 0.3)))
    return (panel, behind) if rng.random() < 0.4 else (panel,)


def _drawer(rng: np.random.Generator) -> tuple[Box, ...]:
    """A front, a floor and a back, no sides."""
    deep, wide = rng.uniform(0.3, 0.5, 2)
    return (
        Box(np.array((-0.01, 0.0, 0.0)), np.array((0.02, wide, 0.25))),
        Box(np.array((-deep / 2, 0.0, -0.115)), np.array((deep, wide - 0.02, 0.015))),
        Box(np.array((-deep + 0.01, 0.0, -0.03)), np.array((0.015, wide - 0.02, 0.17))),
    )


def _in_the_way(rng: np.random.Generator) -> Box:
    centre, size = rng.uniform((-0.6, -0.5, -0.3), (0.5, 0.5, 0.3)), rng.choice(SIZES, 3)
    yaw = float(rng.uniform(-1, 1)) if rng.random() < 0.5 else 0.0
    return Box(centre, size, yaw, str(rng.choice(WHERE)))


def asked(cabinet: Cabinet, file: Path) -> Block | None:
    """Where Φ stops it."""
    file.write_text(cabinet.urdf())
    twin, physics = load_twin(file), Kinematics()
    model = physics._of(twin)
    joint = joint_iri(twin.name(twin.environment), "drawer_joint")
    return physics._sweep_of(model, twin).first_block(twin.state, joint, cabinet.upper)


def passed_through(cabinet: Cabinet, end: float) -> float:
    """How much deeper than allowed the container is in a box at most, on its way to `end` [m]."""
    return max((_too_deep(cabinet, *each, end) for each in _looked_at(cabinet)), default=0.0)


def deepest(cabinet: Cabinet, position: float) -> float:
    """How deep the whole container is in a box at a position [m]."""
    moved = ((_solid(one), cabinet.at(position) * one.pose()) for one in cabinet.own)
    return max(_depth(*one, _solid(other), other.pose()) for one in moved for other in cabinet.others)


def _looked_at(cabinet: Cabinet) -> list[tuple[Box, Box, Box]]:
    """Parts of the container, that of which they are parts, and boxes that stop them."""
    pairs: list[tuple[Box, Box, Box]] = []
    for other in cabinet.others:
        into = [each for each in cabinet.own if _drawn(each, other) > FITTED]
        if cabinet.hinged or not into:
            margin = HINGE if cabinet.hinged else RAILS
        elif other.on == "cabinet" and not any(_goes_through(each, other) for each in into):
            margin = RUNNERS
        else:  # its cabinet's, which houses it or through which it goes: it bears the drawer all along
            continue
        pairs += [(part, one, other) for one in cabinet.own for part in _cores(cabinet, one, margin)]
    return pairs


def _drawn(one: Box, other: Box) -> float:
    return _depth(_solid(one), one.pose(), _solid(other), other.pose())


def _goes_through(one: Box, other: Box) -> bool:
    """Whether a box is on both sides of another along x, and within its outline."""
    (low, high), (below, above) = (
        (each.centre - _half(each), each.centre + _half(each)) for each in (one, other)
    )
    return bool(
        low[0] < below[0]
        and high[0] > above[0]
        and (low[1:] >= below[1:] - 1e-3).all()
        and (high[1:] <= above[1:] + 1e-3).all()
    )


def _half(box: Box) -> Array:
    """Of the box about a box that is turned about the vertical."""
    return np.abs(pin.rpy.rpyToMatrix(0.0, 0.0, box.yaw)) @ box.size / 2


def _cores(cabinet: Cabinet, one: Box, margin: float) -> list[Box]:
    """What of a box is far from hinge or rails."""
    low, high = one.centre - one.size / 2, one.centre + one.size / 2
    if cabinet.hinged:
        ways = ((low, np.minimum(high, (9.0, -margin, 9.0))), (np.maximum(low, (-9.0, margin, -9.0)), high))
    else:
        sides = np.array((-9.0, margin, margin))
        least = np.min([each.centre - each.size / 2 for each in cabinet.own], axis=0) + sides
        most = np.max([each.centre + each.size / 2 for each in cabinet.own], axis=0) - sides
        ways = ((np.maximum(low, least), np.minimum(high, most)),)
    return [Box((a + b) / 2, b - a) for a, b in ways if (b - a > LEAST).all()]


def _too_deep(cabinet: Cabinet, part: Box, whole: Box, other: Box, end: float) -> float:
    drawn = max(0.0, *(_depth(_solid(e), e.pose(), _solid(other), other.pose()) for e in (part, whole)))
    allowed = min(ALLOWED, 0.25 * float(whole.size.min() + other.size.min())) + 2 * drawn
    shapes = _solid(part), _solid(other)
    poses = (cabinet.at(float(each)) * part.pose() for each in np.linspace(0.0, end, LOOKS)[:-1])
    return max(_depth(shapes[0], each, shapes[1], other.pose()) for each in poses) - allowed


def _solid(box: Box) -> coal.Box:
    return coal.Box(*box.size)


def _depth(one: coal.Box, one_at: pin.SE3, other: coal.Box, other_at: pin.SE3) -> float:
    places = (coal.Transform3s(each.rotation, each.translation) for each in (one_at, other_at))
    return -float(
        coal.distance(one, next(places), other, next(places), coal.DistanceRequest(), coal.DistanceResult())
    )
