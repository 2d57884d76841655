"""Random doors and drawers in a kitchen front: what the 1,000-cases figure is measured on.

The robot starts at the origin and looks along x; the front stands across its way.
"""

from dataclasses import dataclass
from pathlib import Path

import numpy as np

DEPTH = 0.02  # [m] of panels and walls
STAND_OFF = 0.045  # [m] from the front to the middle of the bar
BAR = 0.012  # [m] width and depth of the bar
INSET = 0.05  # [m] from the free edge of a door to its bar
GAP = 0.003  # [m] between panel and wall
WALL_HALF, WALL_HEIGHT = 3.0, 2.6  # [m]
HINGE_ABOVE = 0.05  # [m] the floor
SWING = 1.6  # [rad] upper limit of a hinge
HINGES = ("left", "right", "bottom", "drawer")


@dataclass(frozen=True, slots=True)
class Front:
    """One door or drawer.

    Attributes:
        kind: Where the hinge is, or `drawer`.
        width: Of a door from hinge to free edge, of a drawer across [m].
        other: The panel's other extent [m].
        travel: Of a drawer [m].
        length: Of the bar [m].
        handle: Middle of the bar [m] before the robot, beside it, above the floor.
    """

    kind: str
    width: float
    other: float
    travel: float
    length: float
    handle: tuple[float, float, float]


def draw(rng: np.random.Generator) -> Front:
    """A front as the figure asks for, four kinds alike; a hinge at the bottom lies above the floor."""
    while True:
        front = _any(rng)
        if front.kind != "bottom" or front.handle[2] - front.width + INSET > HINGE_ABOVE:
            return front


def _any(rng: np.random.Generator) -> Front:
    kind = HINGES[int(rng.integers(len(HINGES)))]
    handle = (rng.uniform(0.35, 1.0), rng.uniform(-0.6, 0.6), rng.uniform(0.1, 1.9))
    width, travel = rng.uniform(0.25, 0.6), rng.uniform(0.3, 0.5)
    other, length = rng.uniform(0.3, 0.7), rng.uniform(0.1, 0.25)
    if kind == "drawer":
        other = rng.uniform(0.12, 0.3)
    x, y, z = (float(one) for one in handle)
    return Front(kind, float(width), float(other), float(travel), float(length), (x, y, z))


def urdf(front: Front) -> str:
    """The front in a wall, as URDF."""
    x, y, z = front.handle
    plane = x + STAND_OFF  # the outer face
    across, up, offset = _panel(front)
    centre_y, centre_z = y + offset[0], max(z + offset[1], up / 2 + 0.01)
    middle = plane + DEPTH / 2
    hinge = {
        "left": (0.0, across / 2, 0.0),
        "right": (0.0, -across / 2, 0.0),
        "bottom": (0.0, 0.0, -up / 2),
        "drawer": (0.0, 0.0, 0.0),
    }[front.kind]
    joint = _joint(front)
    panel = tuple(-one for one in hinge)
    bar = (-DEPTH / 2 - STAND_OFF - hinge[0], y - centre_y - hinge[1], z - centre_z - hinge[2])
    boxes = "".join(_box(centre, size) for centre, size in _walls(plane, centre_y, centre_z, across, up))
    return f"""<robot name="front">
<link name="world"/>
<link name="wall">{boxes}</link>
<joint name="wall_joint" type="fixed"><parent link="world"/><child link="wall"/></joint>
<link name="front_door">{_box(panel, (DEPTH, across, up))}</link>
<joint name="front_door_joint" {joint}<parent link="wall"/><child link="front_door"/>
<origin xyz="{middle} {centre_y + hinge[1]} {centre_z + hinge[2]}"/></joint>
<link name="front_handle">{_bar(front)}</link>
<joint name="front_handle_joint" type="fixed"><parent link="front_door"/><child link="front_handle"/>
<origin xyz="{bar[0]} {bar[1]} {bar[2]}"/></joint>
</robot>
"""


def _panel(front: Front) -> tuple[float, float, tuple[float, float]]:
    """Extents along y and z [m], and the middle of the panel seen from the handle."""
    reach = front.width / 2 - INSET
    if front.kind == "left":
        return front.width, front.other, (reach, 0.0)
    if front.kind == "right":
        return front.width, front.other, (-reach, 0.0)
    if front.kind == "bottom":
        return front.other, front.width, (0.0, -reach)
    return front.width, front.other, (0.0, 0.0)


def _joint(front: Front) -> str:
    axis = {"left": "0 0 -1", "right": "0 0 1", "bottom": "0 -1 0", "drawer": "-1 0 0"}[front.kind]
    drawer = front.kind == "drawer"
    upper, kind = (front.travel, "prismatic") if drawer else (SWING, "revolute")
    limit = f'<limit lower="0" upper="{upper}" velocity="1" effort="100"/>'
    return f'type="{kind}"><axis xyz="{axis}"/>{limit}'


def _bar(front: Front) -> str:
    """The bar, and two posts that carry it."""
    standing = front.kind in ("left", "right")
    half = front.length / 2 - BAR / 2
    long = (BAR, BAR, front.length) if standing else (BAR, front.length, BAR)
    post = STAND_OFF - BAR / 2
    ends = [(0.0, 0.0, side * half) if standing else (0.0, side * half, 0.0) for side in (1, -1)]
    posts = "".join(_box((BAR / 2 + post / 2, one[1], one[2]), (post, BAR, BAR)) for one in ends)
    return _box((0.0, 0.0, 0.0), long) + posts


def _walls(
    plane: float, y: float, z: float, across: float, up: float
) -> list[tuple[tuple[float, float, float], tuple[float, float, float]]]:
    """Middles and sizes of the four parts of the wall around the panel."""
    middle, low, high = plane + DEPTH / 2, z - up / 2 - GAP, z + up / 2 + GAP
    left, right = y + across / 2 + GAP, y - across / 2 - GAP
    walls = [
        ((middle, (left + WALL_HALF) / 2, WALL_HEIGHT / 2), (DEPTH, WALL_HALF - left, WALL_HEIGHT)),
        ((middle, (right - WALL_HALF) / 2, WALL_HEIGHT / 2), (DEPTH, WALL_HALF + right, WALL_HEIGHT)),
        ((middle, (left + right) / 2, (high + WALL_HEIGHT) / 2), (DEPTH, left - right, WALL_HEIGHT - high)),
    ]
    if low > 0:
        walls.append(((middle, (left + right) / 2, low / 2), (DEPTH, left - right, low)))
    return walls


def _box(centre: tuple[float, ...], size: tuple[float, float, float]) -> str:
    where, extent = (" ".join(f"{one:.6f}" for one in each) for each in (centre, size))
    return f'<collision><origin xyz="{where}"/><geometry><box size="{extent}"/></geometry></collision>'


def write(front: Front, folder: Path, name: str) -> Path:
    """The URDF as a file."""
    path = folder / f"{name}.urdf"
    path.write_text(urdf(front))
    return path
