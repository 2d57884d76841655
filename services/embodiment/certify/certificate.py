"""A certificate as bytes: the motion, what it was judged by, and what was found; all that re-verifies it.

The bytes are two lines, the schema and the SHA-256 of what follows, and then JSON compressed by zlib.
Arrays are their doubles, little endian, in base 64, so that what is read is what was judged, to the
last bit.
"""

import base64
import hashlib
import json
import math
import zlib
from collections.abc import Mapping
from dataclasses import asdict, dataclass
from typing import Any

import numpy as np

from sdt_kg.annotation import Drive
from sdt_kg.errors import InputError
from sdt_kg.iri import Iri
from sdt_kg.motion import Array, BodyMotion, Motion
from sdt_kg.twin import Container, Twin
from services.embodiment.certify.tolerances import Tolerances

SCHEMA = "sdt certificate 1"
MOST_BYTES = 200_000_000
"""[bytes] More than any motion's; a small file cannot claim a memory of its choice."""

Figures = dict[str, tuple[float, str]]
Start = tuple[float, float, float]

_ARRAYS = ("times", "base", "base_v", "q", "v", "kitchen_q", "kitchen_v")


@dataclass(frozen=True, slots=True, eq=False)
class Certificate:
    """What was certified.

    Attributes:
        models: Environment, then robot: IRI → content hash.
        state: Joint IRI → position [rad or m] in which the motion begins.
        container: What is moved.
        drive: What the base can do.
        start: Base pose x, y [m], yaw [rad] at which the robot had to start, parked; None if any would do.
        motion: As executed: between samples it is the cubic Hermite spline.
        figures: What was kept, and by how much: name → (value, unit).
        nearest: What comes nearest, one sentence for each scope; what was not seen; what moves
            besides who holds.
        asked: The container's motion whose times, or else whose way, had to be kept; None where any would do.
        handle: By which it is moved; None: its own.
    """

    models: tuple[tuple[Iri, str], tuple[Iri, str]]
    state: dict[Iri, float]
    container: Iri
    drive: Drive
    start: Start | None
    tolerances: Tolerances
    motion: BodyMotion
    figures: Figures
    nearest: tuple[str, ...] = ()
    asked: Motion | None = None
    handle: Iri | None = None

    @property
    def environment(self) -> Iri:
        """IRI of the kitchen."""
        return self.models[0][0]

    @property
    def robot(self) -> Iri:
        """IRI of the robot."""
        return self.models[1][0]

    def held_in(self, twin: Twin) -> Container:
        """What is moved, by the handle that is held.

        Raises:
            UnknownEntityError: The twin has no such container, or that no such handle.
        """
        return twin.container(self.container).by_handle(self.handle)

    def content(self) -> bytes:
        """The bytes from which `read_certificate` makes it again."""
        return sealed(self.said())

    def said(self) -> dict[str, object]:
        """The JSON object in these bytes; no later change of an array is in it."""
        motion: dict[str, object] = {name: _packed(getattr(self.motion, name)) for name in _ARRAYS}
        motion |= {
            "gripper": self.motion.gripper,
            "joints": list(self.motion.joints),
            "kitchen_joints": list(self.motion.kitchen_joints),
            "phases": [list(phase) for phase in self.motion.phases],
        }
        said: dict[str, object] = {
            "environment": list(self.models[0]),
            "robot": list(self.models[1]),
            "state": self.state,
            "container": self.container,
            "drive": self.drive.value,
            "start": self.start,
            "tolerances": asdict(self.tolerances),
            "motion": motion,
            "figures": {name: list(figure) for name, figure in self.figures.items()},
            "nearest": list(self.nearest),
        }
        if self.handle is not None:
            said["handle"] = self.handle
        if self.asked is not None:
            said["asked"] = _asked_said(self.asked)
        return said


def sealed(said: Mapping[str, object]) -> bytes:
    """The bytes of an artefact around its JSON object."""
    packed = zlib.compress(json.dumps(said).encode("utf-8"), level=1)
    return b"\n".join((SCHEMA.encode("ascii"), _digest(packed), packed))


def models_of(twin: Twin, robot: Iri) -> tuple[tuple[Iri, str], tuple[Iri, str]]:
    """Environment and robot with their content hashes."""
    environment = twin.environment
    return (environment, twin.content_hash(environment)), (robot, twin.content_hash(robot))


def said_in(content: bytes) -> dict[str, Any]:
    """The JSON object in the bytes of a certificate; Any, since anybody may have written it.

    Raises:
        InputError: They are no certificate, or not one byte for byte.
    """
    schema, _, rest = content.partition(b"\n")
    digest, _, packed = rest.partition(b"\n")
    if schema != SCHEMA.encode("ascii"):
        raise InputError(f"an artefact that begins with {schema[:40]!r}", allowed=f"'{SCHEMA}'")
    if digest != _digest(packed):
        raise InputError("the certificate is damaged: its hash is not that of its bytes")
    try:
        said = json.loads(_decompressed(packed), parse_constant=_no_number)
    except (zlib.error, UnicodeDecodeError, ValueError, RecursionError) as error:
        raise InputError(
            f"the certificate cannot be read: {error}", allowed="JSON, compressed by zlib"
        ) from None
    if not isinstance(said, dict):
        raise InputError("the certificate is no JSON object")
    return said


def read_certificate(content: bytes) -> Certificate:
    """The certificate in these bytes.

    Raises:
        InputError: They are none, or a part is missing or of the wrong kind.
    """
    said = said_in(content)
    try:
        return _certificate(said)
    except (AttributeError, KeyError, TypeError, ValueError, OverflowError) as error:
        raise InputError(
            f"the certificate lacks a part, or has one of the wrong kind: {type(error).__name__} {error}",
            remedy="certify the motion again",
        ) from None


def _certificate(said: Mapping[str, Any]) -> Certificate:
    motion, (robot, robot_hash) = said["motion"], said["robot"]
    environment, environment_hash = said["environment"]
    return Certificate(
        models=((_name(environment), _name(environment_hash)), (_name(robot), _name(robot_hash))),
        state={_name(joint): _number(position) for joint, position in said["state"].items()},
        container=_name(said["container"]),
        drive=Drive(said["drive"]),
        start=_start(said["start"]),
        tolerances=Tolerances.told({name: _number(value) for name, value in said["tolerances"].items()}),
        motion=BodyMotion(
            robot=_name(robot),
            gripper=_name(motion["gripper"]),
            joints=tuple(map(_name, motion["joints"])),
            kitchen_joints=tuple(map(_name, motion["kitchen_joints"])),
            phases=tuple((_name(name), int(first)) for name, first in motion["phases"]),
            **{name: _unpacked(motion[name]) for name in _ARRAYS},
        ),
        figures={_name(name): (_number(value), str(unit)) for name, (value, unit) in said["figures"].items()},
        nearest=tuple(map(str, said["nearest"])),
        asked=_asked(said["asked"]) if "asked" in said else None,
        handle=_name(said["handle"]) if "handle" in said else None,
    )


def _asked_said(motion: Motion) -> dict[str, object]:
    velocities = None if motion.velocities is None else _packed(motion.velocities)
    arrays = {"times": _packed(motion.times), "values": _packed(motion.values), "velocities": velocities}
    return {"of": motion.of, **arrays, **({} if motion.timed else {"timed": False})}


def _asked(said: Mapping[str, Any]) -> Motion:
    velocities = None if said["velocities"] is None else _unpacked(said["velocities"])
    arrays, timed = (_unpacked(said["times"]), _unpacked(said["values"])), said.get("timed") is not False
    return Motion(_name(said["of"]), *arrays, timed, velocities)


def _start(said: list[float] | None) -> Start | None:
    if said is None:
        return None
    x, y, yaw = map(_number, said)
    return x, y, yaw


def _packed(array: Array) -> dict[str, object]:
    doubles = np.ascontiguousarray(array, dtype="<f8")
    return {"shape": list(array.shape), "f8": base64.b64encode(doubles.tobytes()).decode("ascii")}


def _unpacked(said: Mapping[str, Any]) -> Array:
    flat = np.frombuffer(base64.b64decode(said["f8"], validate=True), dtype="<f8")
    if any(type(size) is not int or size < 0 for size in said["shape"]):
        raise ValueError(f"the shape {said['shape']}")
    return flat.astype(np.float64).reshape(said["shape"])


def _digest(packed: bytes) -> bytes:
    return hashlib.sha256(packed).hexdigest().encode("ascii")


def _name(said: object) -> str:
    """A name, as models may have it: half of a surrogate pair could not even be hashed."""
    if not isinstance(said, str) or not said.isprintable():
        raise ValueError(f"{said!r} is no name")
    return said


def _number(said: object) -> float:
    """A finite number, told as one: the text "nan" would be one that compares with nothing."""
    if isinstance(said, bool) or not isinstance(said, int | float) or not math.isfinite(said):
        raise ValueError(f"{said!r} is no finite number")
    return float(said)


def _no_number(text: str) -> float:
    """What compares with nothing would pass every bound."""
    raise ValueError(f"{text} is no number that bounds anything")


def _decompressed(content: bytes) -> bytes:
    reader = zlib.decompressobj()
    plain = reader.decompress(content, MOST_BYTES)
    if not reader.eof:
        raise ValueError("it ends too early, or is larger than any motion")
    if reader.unused_data:
        raise ValueError("something follows its end")
    return plain
