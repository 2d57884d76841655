"""What people type, turned into values: tasks, states, base poses."""

import math
import random
from collections.abc import Iterable, Sequence

from sdt_kg.errors import InputError, StateError, UnknownEntityError
from sdt_kg.iri import Iri, local_name
from sdt_kg.state import State
from sdt_kg.task import Task, Verb
from sdt_kg.twin import Container, Twin

HALF_OPEN_MARGIN = 0.1
"""[1] Half-open positions keep this share of the way between closed and open from either end."""


def parse_task(twin: Twin, text: str) -> Task:
    """Task of `open`, `close`, `open:CONTAINER` or `close:CONTAINER`.

    Raises:
        InputError: The verb is not one of D_artic's, or no name follows the colon.
        UnknownEntityError: The kitchen has no such container; the nearest names are told.
    """
    verb_text, colon, container = text.partition(":")
    try:
        verb = Verb(verb_text.strip().lower())
    except ValueError:
        verbs = ", ".join(f"{verb.value}[:CONTAINER]" for verb in Verb)
        raise InputError(f"no task type '{verb_text}'", allowed=verbs) from None
    if not colon:
        return Task(verb)
    if not container.strip():
        raise InputError(f"'{text}' names no container", allowed=f"{verb.value}, or {verb.value}:CONTAINER")
    return Task(verb, twin.container(container.strip()).iri)


def parse_state(twin: Twin, texts: Iterable[str]) -> State:
    """State of the twin's kitchen under `JOINT=VALUE` texts, later ones winning.

    JOINT is a joint or a container; `all` stands for every container. VALUE is a position
    [rad or m] of the joint that is set (for a folding door the one that it follows), `open`
    (upper limit), `closed` (lower limit), or for `all` also `half-open:SEED`: each container
    somewhere between closed and open, drawn with that seed.
    """
    positions = dict(twin.state)
    for text in texts:
        name, equals, value = (part.strip() for part in text.partition("="))
        if not equals or not name or not value:
            raise InputError(
                f"'{text}' is not a joint value",
                allowed="JOINT=VALUE, CONTAINER=open|closed, all=open|closed|half-open:SEED",
            )
        positions.update(_positions(twin, name, value))
    return twin.at(positions).state


def state_joints(twin: Twin, texts: Sequence[str]) -> list[str]:
    """Those of the texts that name a joint or container of this kitchen (or `all`)."""
    known = _names(twin)
    return [text for text in texts if text.partition("=")[0].strip() in {*known, "all"}]


def parse_base(text: str | None) -> tuple[float, float, float] | None:
    """Base pose of `X,Y,YAW` [m, m, rad] in the kitchen's root frame."""
    if text is None:
        return None
    try:
        x, y, yaw = (float(part) for part in text.split(","))
    except ValueError:
        raise InputError(
            f"'{text}' is not a base pose", allowed="X,Y,YAW in m, m, rad, for example 0,0,1.57"
        ) from None
    if not all(math.isfinite(value) for value in (x, y, yaw)):
        raise InputError(f"'{text}' is not a base pose", allowed="finite numbers")
    return x, y, yaw


def _names(twin: Twin) -> dict[str, Iri]:
    """Joint and container name → IRI of the joint that is set."""
    names = {local_name(joint): joint for joint in twin.state}
    return names | {container.name: container.active_joint for container in twin.containers()}


def _positions(twin: Twin, name: str, value: str) -> dict[Iri, float]:
    if name == "all":
        return _all_positions(twin, value)
    names = _names(twin)
    if name not in names:
        raise UnknownEntityError("joint or container", name, names)
    joint = names[name]
    if value in {"open", "closed"}:
        matching = [each for each in twin.containers() if each.active_joint == joint]
        if not matching:
            raise InputError(f"'{name}' is no container", allowed="a position for a joint, for example 0.2")
        return {joint: _active(matching[0], value)}
    try:
        return {joint: float(value)}
    except ValueError:
        raise StateError(f"'{name}={value}' has no number", allowed="a position in rad or m") from None


def _all_positions(twin: Twin, value: str) -> dict[Iri, float]:
    if value in {"open", "closed"}:
        return {each.active_joint: _active(each, value) for each in twin.containers()}
    kind, _, seed = value.partition(":")
    if kind != "half-open" or not seed.isdecimal():
        raise InputError(f"'all={value}' is not a state", allowed="all=open, all=closed, all=half-open:SEED")
    draw = random.Random(int(seed))  # noqa: S311 - a test state, not a secret
    positions: dict[Iri, float] = {}
    for each in twin.containers():
        share = draw.uniform(HALF_OPEN_MARGIN, 1 - HALF_OPEN_MARGIN)
        own = each.closed_to + share * (each.open_from - each.closed_to)
        positions[each.active_joint] = (own - each.offset) / each.multiplier
    return positions


def _active(container: Container, value: str) -> float:
    """Position of the actuated joint at which the container's own joint is at its limit."""
    own = container.upper if value == "open" else container.lower
    return (own - container.offset) / container.multiplier
