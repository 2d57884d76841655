"""A proof as bytes.

The bytes are JSON compressed by zlib. A tree is written in preorder, one byte for each node: below 128
it is the joint whose interval is halved there, lower half first; from 128 on the node is a leaf, and
the rest of the byte is the joint whose origin is too far from the handle in all of the leaf's box, or the
number n of joints where the grasp box itself is apart from it, or n + 1 + c where the arm's core c meets
something solid. A proof about times has no tree but the window of samples that is too fast. "sdt proof 1"
had neither, and is read as it is. "sdt proof 3" is a proof about some holds alone: those `within` a distance.
From 4 on a refutation may have `places`: then its tree is one of cells of them, with trees of joints in it
(`places.py`), and n + 1 + C + k, behind the C cores, says that joint k is too far from the cell. From 5 on
the floor refutes too, from 6 on one may be `pinched`, the fingers' joints last, and a leaf then names the one
finger that may come to the handle (`pinch/`). From 7 on, behind all these numbers are those of
the bodies `beside` the arm; after such a node comes a tree of the joints that carry this body, whose leaves
name cores on them, numbered in the same way (`arm.py`). From 8 on a refutation may be of the
handle `between` two fingers, a box about it and a slab in place of its shapes and the grasp box (`pinch/`).
From 9 on joints of bodies beside the arm that no certified motion moves may be `parked`. From 10 on
a refutation may go up `steps`, a value for each part of the lift (`steps.py`). From 11 on,
where the container is moved by several handles, a claim may be about one that is not its own, and the
proof of its own has those of the `others` with it. From 12 on a claim says
whether it is about motions of `one_hold` alone; older ones are where a refutation has `places` at several
values. From 13 on the fingers of a refutation may be parted where it `ends`: then its tree is two, one after
the other (`pinch/between.py`). From 14 on a core may also reach across something solid (`inside/across.py`).
From 15 on a joint may also be too far from the handle for what is behind it as that is bent in the leaf's box
(`stretch.py`). From 16 on a claim may be about grasps of a `bar` alone. From 17 on a
refutation that is of these, `grasped`, has two trees of the arm's joints and, behind them, of the coordinates
of a grasp (`grasps.py`). A leaf names the joint, or the number n of joints for the tool itself, that is too
far from where a grasp has the tool, or n + 1 and that of one too far from the wrist, or 2n + 2 and the number
of an axis of the tool that points elsewhere; behind these a core of the arm, or of the hand (`loop.py`). What
16 had of grasps is read no more. Written is "sdt proof 18", in which such trees may go over to those of
bodies `beside` the arm, too.
"""

import base64
import binascii
import json
import math
import zlib
from dataclasses import asdict, replace
from typing import Any

from sdt_kg.annotation import Drive
from sdt_kg.errors import InputError
from services.embodiment.certify.tolerances import Tolerances
from services.embodiment.proof_check.proof.claim import Bar, Claim, Timing
from services.embodiment.proof_check.proof.content import Places, Proof, Refutation, Steps, at_one_value

SCHEMA = "sdt proof 18"
TOLD = (*(f"sdt proof {number}" for number in range(12, 18)), SCHEMA)  # one hold or more, and in which words
BY_PLACES, OF_CELLS = "sdt proof 4", "sdt proof 16"
SINCE_BARS = (OF_CELLS, "sdt proof 17", SCHEMA)
SINCE_DECLARED = (*(f"sdt proof {number}" for number in range(6, 18)), SCHEMA)
SINCE_SOME_HOLDS = ("sdt proof 3", BY_PLACES, "sdt proof 5", *SINCE_DECLARED)
READ = ("sdt proof 1", "sdt proof 2", *SINCE_SOME_HOLDS)
MOST_BYTES = 20_000_000
"""[bytes] More than any proof's; a small file cannot claim a memory of its choice."""


def to_bytes(proof: Proof) -> bytes:
    """The proof as an artefact's content; the same proof gives the same bytes."""
    whole = {"schema": SCHEMA, **_told(proof), "others": [_told(each) for each in proof.others]}
    return zlib.compress(json.dumps(whole, sort_keys=True).encode(), 9)


def _told(proof: Proof) -> dict[str, object]:
    """The proof by one handle as JSON has it."""
    refutations = [
        asdict(one) | {"tree": base64.b64encode(one.tree).decode("ascii")} for one in proof.refutations
    ]
    return {
        "claim": asdict(proof.claim) | {"drive": proof.claim.drive.value},
        "assumptions": proof.assumptions(),
        "refutations": refutations,
        "window": proof.window,
    }


def is_proof(content: bytes) -> bool:
    """Whether the bytes are a proof's, as far as their beginning tells."""
    try:
        return _unpacked(content).get("schema") in READ
    except InputError:
        return False


def read_proof(content: bytes) -> Proof:
    """The proof of an artefact's content.

    Raises:
        InputError: It is none, or damaged.
    """
    whole = _unpacked(content)
    if whole.get("schema") not in READ:
        raise InputError(f"a proof of the schema '{whole.get('schema')}'", allowed=" or ".join(READ))
    try:
        others = tuple(_proof(each, whole["schema"]) for each in whole.get("others", ()))
        return replace(_proof(whole, whole["schema"]), others=others)
    except (KeyError, TypeError, ValueError, AttributeError, OverflowError, binascii.Error) as error:
        raise InputError(f"the proof is damaged: {error!r}", allowed=f"a whole {SCHEMA}") from None


def _proof(given: dict[str, Any], schema: str) -> Proof:  # Any: JSON
    """The proof by one handle."""
    refutations = tuple(_refutation(one) for one in given["refutations"])
    claim, told = _claim(given["claim"], schema), given["claim"].get("one_hold")
    if type(told) is not (bool if schema in TOLD else type(None)):
        raise ValueError(f"whether one hold alone is meant is not told in {schema}")
    one_hold = not at_one_value(refutations) if told is None else told
    proof = Proof(replace(claim, one_hold=one_hold), refutations, _window(given.get("window")))
    misstated = schema in TOLD and given["assumptions"] != [*proof.assumptions()]  # others had other words
    return replace(proof, misstated=misstated)


def _unpacked(content: bytes) -> dict[str, Any]:  # Any: JSON
    unzip = zlib.decompressobj()
    try:
        text = unzip.decompress(content, MOST_BYTES)
        whole = json.loads(text)
    except (zlib.error, ValueError, RecursionError) as error:
        raise InputError(f"the proof cannot be read: {error}", allowed="JSON compressed by zlib") from None
    if not isinstance(whole, dict) or unzip.unconsumed_tail or unzip.unused_data or not unzip.eof:
        raise InputError("the proof cannot be read", allowed="one JSON object of at most 20 MB")
    return whole


def _claim(given: dict[str, Any], schema: str) -> Claim:  # Any: JSON
    if schema != BY_PLACES and ("within" in given) is not (schema in SINCE_SOME_HOLDS):
        raise ValueError(f"which holds are meant is not told in {schema}")
    if schema == OF_CELLS and given.get("bar") is not None:
        raise InputError(f"a proof about a set of grasps of the schema '{schema}'", allowed="one made anew")
    if ("bar" not in given) if schema in SINCE_BARS else given.get("bar") is not None:
        raise ValueError(f"which grasps are meant is not told in {schema}")
    if ("declared" in given) is not (schema in SINCE_DECLARED) or type(
        given.get("declared", False)
    ) is not bool:
        raise ValueError(f"how the robot's bodies are taken is not told in {schema}")
    environment, robot = ((str(iri), str(known)) for iri, known in given["models"])
    low, high = (_number(each) for each in given["span"])
    x, y, yaw = (_number(each) for each in given["start"])
    return Claim(
        (environment, robot),
        {str(joint): _number(value) for joint, value in given["state"].items()},
        str(given["container"]),
        (low, high),
        Drive(given["drive"]),
        (x, y, yaw),
        Tolerances.told({name: _number(value) for name, value in given["tolerances"].items()}),
        _timing(given.get("timing")),
        None if given.get("within") is None else _number(given["within"]),
        given.get("declared", False),
        None if given.get("handle") is None else str(given["handle"]),
        bar=_bar(given.get("bar")),
    )


def _bar(given: dict[str, Any] | None) -> Bar | None:  # Any: JSON
    if given is None:
        return None
    centre, along, outward = (
        (_number(x), _number(y), _number(z))
        for x, y, z in (given[name] for name in ("centre", "along", "outward"))
    )
    return Bar(centre, along, outward, _number(given["reach"]))


def _timing(given: dict[str, Any] | None) -> Timing | None:  # Any: JSON
    if given is None:
        return None
    times, values = (tuple(_number(one) for one in given[name]) for name in ("times", "values"))
    if len(times) != len(values):
        raise ValueError("as many times as values")
    return Timing(times, values)


def _window(given: list[Any] | None) -> tuple[int, int] | None:  # Any: JSON
    if given is None:
        return None
    first, last = given
    if type(first) is not int or type(last) is not int:
        raise ValueError(f"{given!r} is no window")
    return first, last


def _refutation(given: dict[str, Any]) -> Refutation:  # Any: JSON
    places, ends = given.get("places"), given.get("ends")
    return Refutation(
        str(given["gripper"]),
        _number(given["value"]),
        tuple(str(each) for each in given["joints"]),
        _box(given["box"]),
        base64.b64decode(given["tree"], validate=True),
        None if places is None else Places(tuple(map(_number, places["values"])), _box(places["box"])),
        given.get("pinched") is True,
        tuple(str(each) for each in given.get("beside", ())),
        given.get("between") is True,
        given.get("parked") is True,
        _steps(given.get("steps")),
        None if ends is None else _number(ends),
        given.get("grasped") is True,
    )


def _steps(given: dict[str, Any] | None) -> Steps | None:  # Any: JSON
    if given is None:
        return None
    pieces = tuple(given["pieces"])
    if any(type(one) is not int or one < 0 for one in pieces):
        raise ValueError(f"{pieces!r} are no numbers of pieces")
    return Steps(tuple(map(_number, given["values"])), pieces)


def _box(given: list[list[object]]) -> tuple[tuple[float, float], ...]:
    return tuple((_number(low), _number(high)) for low, high in given)


def _number(given: object) -> float:
    if isinstance(given, bool) or not isinstance(given, int | float) or not math.isfinite(given):
        raise ValueError(f"{given!r} is no finite number")
    return float(given)
