"""Random mechanisms with random force data, as URDF and Turtle."""

import math
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

KINDS = ("drawer", "slanted drawer", "door", "flap", "slanted door", "leaves", "drawers", "folding")
"""What moves: alone, tied to another by a mimic, or one panel on the other."""

TIED = {"leaves": -1.0, "drawers": 0.5, "folding": 2.0}
"""Kind → position of the second joint for each rad or m of the first."""

SCALES = {
    "movedMass": (1.0, 20.0),
    "contentsMass": (0.0, 8.0),
    "coulombFriction": (0.0, 8.0),
    "breakAwayFriction": (0.0, 12.0),
    "viscousFriction": (0.0, 12.0),
    "springStiffness": (0.0, 20.0),
    "latchForce": (0.0, 40.0),
    "softCloserForce": (0.0, 15.0),
    "softCloserDamping": (0.0, 60.0),
}
"""[SI units of the joint] Between what intervals are drawn."""


@dataclass(frozen=True)
class Values:
    """One value of each parameter of one joint; u and w are the factors of its inertia and of its weight."""

    figures: dict[str, float]
    u: float
    w: float


@dataclass(frozen=True)
class Forces:
    """Force data of one joint: intervals and lengths."""

    intervals: dict[str, tuple[float, float]]
    spread: float
    rest: float
    latch_width: float
    closer_range: float

    def some(self, draw: np.random.Generator) -> Values:
        """Values in the intervals: as often at their ends as between them."""

        def one(low: float, high: float) -> float:
            share = draw.random() if draw.random() < 0.5 else float(draw.integers(2))
            return low + share * (high - low)

        figures = {name: one(*ends) for name, ends in self.intervals.items()}
        figures["breakAwayFriction"] = max(figures["breakAwayFriction"], figures["coulombFriction"])
        return Values(figures, one(1 - self.spread, 1 + self.spread), one(1 - self.spread, 1 + self.spread))

    def largest(self) -> Values:
        """The upper end of every interval."""
        return Values(
            {name: high for name, (_, high) in self.intervals.items()}, 1 + self.spread, 1 + self.spread
        )


@dataclass(frozen=True)
class Drawn:
    """A mechanism: its files, and its parts as they were written."""

    kind: str
    urdf: str
    ttl: str
    container: str
    joints: tuple[str, ...]
    ratios: tuple[float, ...]
    forces: tuple[Forces, ...]
    allowed: float
    handle_box: tuple[float, float, float]
    handle_at: tuple[float, float, float]

    def write(self, folder: Path) -> tuple[Path, Path]:
        """The URDF and the force data as files."""
        model, data = folder / "m.urdf", folder / "forces.ttl"
        model.write_text(self.urdf)
        data.write_text(self.ttl)
        return model, data


def draw(number: int) -> Drawn:
    """The mechanism of that number."""
    rng = np.random.default_rng(number)
    kind = KINDS[number % len(KINDS)]
    slides = kind in {"drawer", "slanted drawer", "drawers"}
    container = f"top_{'drawer' if slides else 'door'}"
    axis = _axis(kind, rng)
    size, middle = _panel(kind, rng)
    handle_box = tuple(float(x) for x in rng.uniform(0.01, 0.15, 3))
    handle_at = (-0.05, float(rng.uniform(-0.1, 0.1)) + 1.7 * middle[1], 1.7 * middle[2])
    upper = float(rng.uniform(0.25, 0.5) if slides else rng.uniform(0.9, 1.6))
    links = [_link("wall", (0.02, 4, 2), (1.0, 0, 1)), _link(container, size, middle)]
    links.append(_link("top_handle", handle_box, (0, 0, 0)))
    first, second = f"{container}_joint", "second_joint"
    type_ = "prismatic" if slides else "revolute"
    joints = [_fixed("wall_joint", "room", "wall", (2, 0, 0))]
    names, ratios = (first,), (1.0,)
    if kind == "folding":  # the handle's panel hangs on the second one and turns back twice as far
        links.append(_link("above", size, middle))
        joints.append(_joint(second, type_, ("wall", "above"), (0, 0, 1.5), axis, upper / 2))
        along = tuple(2 * x for x in middle)
        back = tuple(-x for x in axis)
        joints.append(_joint(first, type_, ("above", container), along, back, upper, mimic=(second, 2.0)))
        names, ratios = (first, second), (1.0, 0.5)
    else:
        joints.append(_joint(first, type_, ("wall", container), (0, 0, 1), axis, upper))
    if kind in {"leaves", "drawers"}:
        links.append(_link("other", size, middle))
        ratio = TIED[kind]
        joints.append(
            _joint(second, type_, ("wall", "other"), (0, 2, 1), axis, ratio * upper, mimic=(first, ratio))
        )
        names, ratios = (first, second), (1.0, ratio)
    joints.append(_fixed("top_handle_joint", container, "top_handle", handle_at))
    text = f'<robot name="m"><link name="room"/>{"".join(links)}{"".join(joints)}</robot>'
    folds = kind == "folding"
    light = 0.05 if folds else 1.0  # or friction holds it nowhere
    forces = tuple(_forces(slides, upper, light, rng) for _ in names)
    allowed = float(10 ** rng.uniform(0.5, 2.3)) * (5.0 if folds else 1.0)  # its handle moves little at first
    ttl = _ttl(names, forces, slides, allowed)
    return Drawn(kind, text, ttl, container, names, ratios, forces, allowed, handle_box, handle_at)


def _axis(kind: str, rng: np.random.Generator) -> tuple[float, float, float]:
    tilt = float(rng.uniform(-0.3, 0.3))
    if kind in {"drawer", "drawers"}:
        return (-1.0, 0.0, 0.0)
    if kind == "slanted drawer":
        return (-math.cos(tilt), 0.0, math.sin(tilt))
    if kind in {"door", "leaves"}:
        return (0.0, 0.0, -1.0)
    if kind == "slanted door":
        return (math.sin(tilt), 0.0, -math.cos(tilt))
    return (0.0, 1.0, 0.0) if kind == "folding" else (0.0, -1.0, 0.0)


def _panel(
    kind: str, rng: np.random.Generator
) -> tuple[tuple[float, float, float], tuple[float, float, float]]:
    """Size of a panel, and its middle seen from its joint [m]."""
    wide, high = float(rng.uniform(0.3, 0.6)), float(rng.uniform(0.2, 0.6))
    middle = {
        "flap": (0.0, 0.0, high / 2),
        "folding": (0.0, 0.0, -high / 2),
        "door": (0.0, -wide / 2, 0.0),
        "leaves": (0.0, -wide / 2, 0.0),
        "slanted door": (0.0, -wide / 2, 0.0),
    }.get(kind, (0.0, 0.0, 0.0))
    return (0.02, wide, high), middle


def _forces(slides: bool, upper: float, light: float, rng: np.random.Generator) -> Forces:
    lightness = 1.0 if slides else 0.3
    intervals = {}
    for name, (low, high) in SCALES.items():
        factor = light if name.endswith("Mass") else lightness
        few = rng.random() < 0.4 and not name.endswith("Mass") and "Friction" not in name
        ends = np.sort(rng.uniform(low, high, 2)) * factor * (0.0 if few else 1.0)
        if rng.random() < 0.5:  # narrow intervals decide more often
            ends = ends[0] + (ends - ends[0]) * 0.1
        intervals[name] = (float(ends[0]), float(ends[1]))
    low, high = (intervals["breakAwayFriction"][k] + intervals["coulombFriction"][1] for k in (0, 1))
    intervals["breakAwayFriction"] = (low, high)
    spread = 0.0 if slides else float(rng.uniform(0.0, 0.3))
    rest, width = float(rng.uniform(-0.1, upper)), float(rng.uniform(0.001, 0.05))
    return Forces(intervals, spread, rest, width, float(rng.uniform(0.0, 0.1)))


def _ttl(names: tuple[str, ...], forces: tuple[Forces, ...], slides: bool, allowed: float) -> str:
    lines = ["@prefix sdt: <https://example.org/sdt#> ."]
    for name, one in zip(names, forces, strict=True):
        model = f"<https://example.org/id/m/force_model/{name}>"
        figures = {
            f"{key}{end}": v
            for key, ends in one.intervals.items()
            for end, v in zip(("From", "To"), ends, strict=True)
        }
        figures |= {"massSpread": one.spread, "springRestPosition": one.rest, "latchWidth": one.latch_width}
        figures |= {"softCloserRange": one.closer_range, "allowedHandleForce": allowed}
        said = " ; ".join(f"sdt:{key} {value!r}" for key, value in figures.items())
        lines.append(f"{model} a sdt:{'Slide' if slides else 'Hinge'}ForceModel ; {said} .")
        lines.append(f"<https://example.org/id/m/joint/{name}> sdt:hasForceModel {model} .")
    return "\n".join(lines)


def _link(name: str, size: tuple[float, ...], at: tuple[float, ...]) -> str:
    box = f'<geometry><box size="{_text(size)}"/></geometry>'
    return f'<link name="{name}"><collision><origin xyz="{_text(at)}"/>{box}</collision></link>'


def _fixed(name: str, parent: str, child: str, at: tuple[float, ...]) -> str:
    ends = f'<parent link="{parent}"/><child link="{child}"/>'
    return f'<joint name="{name}" type="fixed">{ends}<origin xyz="{_text(at)}"/></joint>'


def _joint(  # noqa: PLR0917 - what a joint of a URDF has
    name: str,
    type_: str,
    ends: tuple[str, str],
    at: tuple[float, ...],
    axis: tuple[float, ...],
    reach: float,
    mimic: tuple[str, float] | None = None,
) -> str:
    low, high = sorted((0.0, reach))
    follows = "" if mimic is None else f'<mimic joint="{mimic[0]}" multiplier="{mimic[1]}"/>'
    return (
        f'<joint name="{name}" type="{type_}"><parent link="{ends[0]}"/><child link="{ends[1]}"/>'
        f'<origin xyz="{_text(at)}"/><axis xyz="{_text(axis)}"/>'
        f'<limit lower="{low}" upper="{high}" velocity="5" effort="50"/>{follows}</joint>'
    )


def _text(numbers: tuple[float, ...]) -> str:
    return " ".join(repr(float(each)) for each in numbers)


def point(drawn: Drawn, rng: np.random.Generator) -> Array:
    """A point of the handle's box, in the frame of the panel."""
    return np.array(drawn.handle_at) + rng.uniform(-0.5, 0.5, 3) * np.array(drawn.handle_box)
