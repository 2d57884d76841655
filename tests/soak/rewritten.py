"""Mutations of a certified motion, of the robot and of the kitchen, as arrays and files that all can read."""

import shutil
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from xml.etree import ElementTree

import numpy as np

import kitchens
import robots

Motion = Mapping[str, np.ndarray]
Random = np.random.Generator
WIDTHS = (0.5, 3.0)  # [s] of a bump
THIN = 0.001  # [m] of a wall
SEED = 11
PARTS = (("base", "base_velocities"), ("robot_positions", "robot_velocities"))


@dataclass(frozen=True)
class Variant:
    """A motion, and the files of the models in which it is judged.

    Attributes:
        folder: For files of its own.
        held_otherwise: Whether the handle is elsewhere, so that an audit cannot call the grip right.
    """

    name: str
    motion: Motion
    kitchen: Path
    robot: Path
    folder: Path
    drive: str = "omni"
    held_otherwise: bool = False


def variants(motion: Motion, robot: str, handle: str, folder: Path, count: int) -> Iterator[Variant]:
    """So many, the same every time; the first is the motion as it is.

    Args:
        motion: Arrays of a file.
        robot: Bundled name.
        handle: Link of the handle.
        folder: For changed files.
        count: How many.
    """
    plain = Variant("plain", motion, kitchens.path("b/b.urdf"), robots.path(f"{robot}/{robot}.urdf"), folder)
    yield plain
    random = np.random.default_rng(SEED)
    kinds: list[Callable[[Random, Variant], Variant]] = [waypoint, waypoint, bump, bump, bump, tempo, shifted]
    kinds += [limit, wall, another, lambda one, variant: moved(one, variant, handle)]
    for number in range(1, count):
        own = folder / str(number)
        yield kinds[int(random.integers(len(kinds)))](random, replace(plain, folder=own))


def size(random: Random, least: float, most: float) -> float:
    """Log-uniform, of either sign."""
    return float(np.exp(random.uniform(np.log(least), np.log(most))) * random.choice((-1, 1)))


def _arm(motion: Motion) -> list[int]:
    """Columns of joints that move, one by one, and are no gripper's: how fingers hold is another test's."""
    q, names = motion["robot_positions"], motion["robot_joint_names"].tolist()
    alone = [sum(np.array_equal(one, other) for other in q.T) == 1 and np.ptp(one) > 0.01 for one in q.T]
    return [k for k, name in enumerate(names) if alone[k] and "gripper" not in name]


def _column(random: Random, motion: Motion) -> tuple[int, int]:
    """Base or robot, and a column of it."""
    part = int(random.random() < 0.7)
    return part, int(random.choice(_arm(motion) if part else 3))


def _changed(motion: Motion, where: tuple[int, int], by: np.ndarray, rate: np.ndarray) -> Motion:
    (positions, velocities), column = PARTS[where[0]], where[1]
    q, v = motion[positions].copy(), motion[velocities].copy()
    q[:, column] += by
    v[:, column] += rate
    return {**motion, positions: q, velocities: v}


def waypoint(random: Random, variant: Variant) -> Variant:
    by = np.zeros(len(variant.motion["times"]))
    by[random.integers(len(by))] = size(random, 1e-5, 0.03)
    where = _column(random, variant.motion)
    return replace(variant, name="waypoint", motion=_changed(variant.motion, where, by, np.zeros_like(by)))


def bump(random: Random, variant: Variant) -> Variant:
    """A coordinate leaves its way, slowly, and comes back."""
    times = variant.motion["times"]
    width, most = random.uniform(*WIDTHS), size(random, 1e-4, 0.2)
    phase = (times - random.uniform(0, times[-1] - width)) / width
    inside = (phase > 0) & (phase < 1)
    by = np.where(inside, most * np.sin(np.pi * phase) ** 2, 0)
    rate = np.where(inside, most * np.pi / width * np.sin(2 * np.pi * phase), 0)
    where = _column(random, variant.motion)
    return replace(variant, name="bump", motion=_changed(variant.motion, where, by, rate))


def tempo(random: Random, variant: Variant) -> Variant:
    motion, scale = variant.motion, random.uniform(0.7, 1.6)
    slower = {name: value / scale for name, value in motion.items() if name.endswith("_velocities")}
    return replace(variant, name="tempo", motion={**motion, **slower, "times": motion["times"] * scale})


def shifted(random: Random, variant: Variant) -> Variant:
    """The base stands elsewhere, all along."""
    by = np.full(len(variant.motion["times"]), size(random, 1e-5, 0.05))
    where = 0, int(random.integers(3))
    return replace(variant, name="base", motion=_changed(variant.motion, where, by, np.zeros_like(by)))


def another(random: Random, variant: Variant) -> Variant:
    """The other gripper is said to act, or another drive; all of them wrong."""
    gripper = {"left": "right", "right": "left"}.get(str(variant.motion["gripper"]))
    if gripper is None or random.random() < 0.5:
        return replace(variant, name="drive", drive="fixed")
    return replace(variant, name="gripper", motion={**variant.motion, "gripper": np.array(gripper)})


def limit(random: Random, variant: Variant) -> Variant:
    """A limit of a joint shrinks to about what the motion uses of it."""
    motion = variant.motion
    column = int(random.choice(_arm(motion)))
    name = str(motion["robot_joint_names"][column])
    kind = str(random.choice(("upper", "velocity")))
    used = motion["robot_positions" if kind == "upper" else "robot_velocities"][:, column]
    most = float(used.max() if kind == "upper" else np.abs(used).max())
    value = most + abs(most) * size(random, 1e-3, 0.3)

    def shrink(root: ElementTree.Element) -> None:
        known = root.find(f"joint[@name='{name}']/limit")
        assert known is not None
        low = float(known.get("lower", "0")) + 1e-3 if kind == "upper" else 1e-3
        parked = float(used[0]) if kind == "upper" else 0.0
        known.set(kind, repr(max(value, low, parked)))

    return replace(variant, name=f"{kind} of {name}", robot=_rewritten(variant.robot, variant.folder, shrink))


def wall(random: Random, variant: Variant) -> Variant:
    """A board of 1 mm, across the way or beside it."""
    base = variant.motion["base"][int(random.integers(len(variant.motion["times"])))]
    extent = np.array([0.2, 0.2, 0.2])
    extent[random.integers(3)] = THIN
    centre = (
        base[0] + random.uniform(-0.9, 0.9),
        base[1] + random.uniform(-0.9, 0.9),
        random.uniform(0.1, 1.3),
    )
    xyz, box = " ".join(map(repr, map(float, centre))), " ".join(map(repr, extent.tolist()))
    return replace(variant, name="wall", kitchen=with_box(variant.kitchen, variant.folder, box, xyz))


def moved(random: Random, variant: Variant, handle: str) -> Variant:
    """The handle is elsewhere."""
    by = np.zeros(3)
    by[random.integers(3)] = size(random, 1e-4, 0.03)

    def shift(root: ElementTree.Element) -> None:
        child = next(
            each for each in root.findall("joint") if each.find(f"child[@link='{handle}']") is not None
        )
        origin = child.find("origin")
        assert origin is not None
        xyz = np.array([float(word) for word in origin.get("xyz", "0 0 0").split()]) + by
        origin.set("xyz", " ".join(map(repr, xyz.tolist())))

    kitchen = _rewritten(variant.kitchen, variant.folder, shift)
    return replace(variant, name="handle", kitchen=kitchen, held_otherwise=True)


def _rewritten(file: Path, folder: Path, edit: Callable[[ElementTree.Element], None]) -> Path:
    """The model with an edit, in a folder of its own, beside its annotation."""
    folder.mkdir(parents=True, exist_ok=True)
    tree = ElementTree.parse(file)  # noqa: S314 - bundled
    edit(tree.getroot())
    tree.write(folder / file.name)
    annotation = file.with_suffix(".ttl")
    shutil.copy(annotation, folder / annotation.name)
    return folder / file.name


def with_limit(kitchen: Path, folder: Path, joint: str, upper: float) -> Path:
    """The kitchen with another upper limit of a joint."""

    def shrink(root: ElementTree.Element) -> None:
        known = root.find(f"joint[@name='{joint}']/limit")
        assert known is not None
        known.set("upper", repr(upper))

    return _rewritten(kitchen, folder, shrink)


def with_origin(kitchen: Path, folder: Path, joint: str, xyz: str) -> Path:
    """The kitchen with a joint elsewhere."""

    def put(root: ElementTree.Element) -> None:
        origin = root.find(f"joint[@name='{joint}']/origin")
        assert origin is not None
        origin.set("xyz", xyz)

    return _rewritten(kitchen, folder, put)


def with_box(kitchen: Path, folder: Path, size: str, xyz: str) -> Path:
    """The kitchen with a box in it."""
    return _rewritten(kitchen, folder, lambda root: _stand(root, size, xyz))


def _stand(root: ElementTree.Element, size: str, xyz: str) -> None:
    children = {str(each.get("link")) for each in root.findall("joint/child")}
    first = next(each for each in root.findall("link") if each.get("name") not in children)
    shape = f'<collision><geometry><box size="{size}"/></geometry></collision>'
    root.append(ElementTree.fromstring(f'<link name="board">{shape}</link>'))  # noqa: S314 - ours
    joint = (
        f'<joint name="board_joint" type="fixed"><parent link="{first.get("name")}"/>'
        f'<child link="board"/><origin xyz="{xyz}"/></joint>'
    )
    root.append(ElementTree.fromstring(joint))  # noqa: S314 - ours
