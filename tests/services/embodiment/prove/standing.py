"""Fronts before a robot that stands, proofs that the container comes into it, and checks of changed ones."""

import json
import re
import zlib
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np

from sdt_kg.annotation import Drive
from sdt_kg.load import model_path
from sdt_kg.twin import Twin
from services.embodiment.proof_check import check
from services.embodiment.prove.prover import Proved, Prover
from tests.small import beside
from tests.soak.doors import Front, draw, write

HERE = (0.0, 0.0, 0.0)
Change = Callable[[dict[str, Any]], None]
Known = tuple[Twin, Proved]
"""A front with a robot, and what is proved of it."""


def front(folder: Path, robot: str, what: int | Front) -> Twin:
    """A front, or the one that is drawn from a seed, with the robot."""
    drawn = draw(np.random.default_rng(what)) if isinstance(what, int) else what
    return beside(write(drawn, folder, "front"), robot)


def up_to_its_stops(folder: Path, robot: str) -> str:
    """A bundled robot whose joints have no limits but their stops."""
    return _rewritten(folder, robot, ".urdf", r"<safety_controller [^>]*/>", "")[0]


def without_cores(folder: Path, robot: str, body: str) -> str:
    """A bundled robot of which nothing is known inside one body."""
    path, count = _rewritten(folder, robot, ".ttl", rf"<[^>]*/body/{body}> sdt:hasCore .*\n", "")
    assert count == 1
    return path


def with_held_head(folder: Path, robot: str) -> str:
    """A bundled robot whose head no motion turns, as nothing says how fast it may become."""
    head = r"(joint/[a-z_]*head_[a-z0-9_]*>) sdt:accelerationLimit [0-9.]+ \."
    path, count = _rewritten(folder, robot, ".ttl", head, r"\1 sdt:held true .")
    assert count == 2
    return path


def _rewritten(folder: Path, robot: str, end: str, pattern: str, text: str) -> tuple[str, int]:
    """Where a bundled robot lies of which one file says something else, and how often that differs."""
    count = 0
    for suffix in (".urdf", ".ttl"):
        file = model_path("robot", robot).with_suffix(suffix)
        written = file.read_text()
        if suffix == end:
            written, count = re.subn(pattern, text, written)
        (folder / file.name).write_text(written)
    return str(folder / model_path("robot", robot).with_suffix(".urdf").name), count


def swept(twin: Twin, declared: bool = False) -> Proved | None:
    """What is proved of opening it with the base here."""
    door = twin.container("front_door")
    values = np.array([0.0, door.open_from])
    return Prover(twin, twin.robots[0], door, Drive.FIXED, HERE, values, declared=declared).swept()


def refuted_front(folder: Path, robot: str, what: int | Front) -> Known:
    """A front with the robot, which is refuted."""
    twin = front(folder, robot, what)
    proved = swept(twin)
    assert proved is not None
    return twin, proved


def changed(content: bytes, change: Change) -> bytes:
    """A proof that says something else."""
    whole = json.loads(zlib.decompress(content))
    change(whole)
    return zlib.compress(json.dumps(whole).encode())


def again(known: Known, change: Change = lambda _: None) -> tuple[bool, str]:
    """Whether a changed proof holds, and what it says."""
    twin, proved = known
    content = changed(proved.artefact.content, change)
    checked = check(twin, twin.robots[0], twin.container("front_door"), content)
    return checked.holds, " ".join((*checked.reasons, checked.statement, *checked.assumptions))
