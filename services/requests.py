"""What people type, turned into values: tasks, states, base poses."""

import math
import random
import re
from collections.abc import Iterable, Sequence
from dataclasses import replace
from typing import Final, TypeVar

from sdt_kg.errors import InputError, StateError, UnknownEntityError
from sdt_kg.iri import Iri, body_iri, joint_iri, local_name
from sdt_kg.motion import BodyMotion, Motion
from sdt_kg.numbers import number_in, whole_in
from sdt_kg.state import State
from sdt_kg.task import UNKNOWN, Task, Verb
from sdt_kg.twin import Container, Twin
from services.policy import LEAST_FRICTION, MOST_FRICTION

ARRAYS = ("times", "values", "velocities", "base", "q", "v", "base_v", "kitchen_q", "kitchen_v")
"""Of motions."""
REAL = "fiu"
"""Kinds of NumPy's types whose values are real numbers."""
AnyMotion = TypeVar("AnyMotion", bound=Motion | BodyMotion)
ASKED = "asked"
"""In states of many cases: the container that each is about."""
SAME = 1e-9
"""[rad or m] Two texts put a joint at one place: of doors that move together, each computes it by itself."""
MOST_SEEDS = 1_000_000
"""[1] Of one sweep: each combination with a drive and a start is made before anything is judged."""
HALF_OPEN_MARGIN = 0.1
"""[1] Half-open positions keep this share of the way between closed and open from either end."""

_LISTED: Final = re.compile(r"([^=]*(?:=[^,]*|$))(?:,|$)")


def parse_task(twin: Twin, text: str) -> Task:
    """Task of `open`, `close`, `open:CONTAINER` or `close:CONTAINER`.

    Raises:
        InputError: The verb is not one of D_artic's, or no name follows the colon.
        UnknownEntityError: The kitchen has no such container; the nearest names are told.
    """
    _check_text(text, "a task", "open, open:CONTAINER, close, close:CONTAINER, or a Task")
    verb_text, colon, container = text.partition(":")
    try:
        verb = Verb(verb_text.strip().lower())
    except ValueError:
        verbs = ", ".join(f"{verb.value}[:CONTAINER]" for verb in Verb)
        raise InputError(
            f"no task type '{verb_text}'", allowed=verbs, remedy=_without_colon(twin, text)
        ) from None
    if not colon:
        return Task(verb)
    if not container.strip():
        raise InputError(f"'{text}' names no container", allowed=f"{verb.value}, or {verb.value}:CONTAINER")
    return Task(verb, twin.container(container.strip()).iri)


def _without_colon(twin: Twin, text: str) -> str:
    """What a container's name without a colon, perhaps after a verb, may mean; empty of other texts."""
    verb, _, name = text.strip().rpartition(" ")
    verbs = {each.value for each in Verb}
    if name not in {each.name for each in twin.containers()}:
        return ""
    return f"did you mean {verb.lower() if verb.lower() in verbs else Verb.OPEN.value}:{name}?"


def task_of_one(twin: Twin, text: str) -> Task:
    """Task of `open:CONTAINER` or `close:CONTAINER`, where there has to be one container.

    Raises:
        InputError: As `parse_task`; or no container is named.
        UnknownEntityError: The kitchen has no such container; the nearest names are told.
    """
    task = parse_task(twin, text)
    if task.container is UNKNOWN:
        raise InputError(f"'{text}' names no container", allowed="open:CONTAINER or close:CONTAINER")
    return task


def parse_state(twin: Twin, texts: Iterable[str]) -> State:
    """State of the twin's kitchen under `JOINT=VALUE` texts.

    JOINT is a joint or a container; `all` stands for every container, but for those that are named
    after it. VALUE is a position [rad or m] of the joint that is set (for a folding door the one that
    it follows), `open` (upper limit), `closed` (lower limit), or for `all` also `half-open:SEED`: each
    container somewhere between closed and open, drawn with that seed.

    Raises:
        InputError: A text is none of these, or puts a joint elsewhere than one before it that names it.
        UnknownEntityError: There is no such joint or container.
        StateError: The state is outside of limits.
    """
    positions, named = dict(twin.state), dict[Iri, str]()
    for text in texts:
        _check_text(text, "a state", "texts: JOINT=VALUE, CONTAINER=open|closed")
        name, equals, value = (part.strip() for part in text.partition("="))
        if not equals or not name or not value:
            raise InputError(
                f"'{text}' is not a joint value",
                allowed="JOINT=VALUE, CONTAINER=open|closed, all=open|closed|half-open:SEED",
            )
        found = _positions(twin, name, value)
        moved = {joint for joint, at in found.items() if not math.isclose(at, positions[joint], abs_tol=SAME)}
        for joint in named.keys() & moved:
            raise InputError(
                f"'{named[joint]}' and '{text}' put one joint at two places",
                allowed="each joint once; 'all=…' before those that are elsewhere",
            )
        positions.update(found)
        named |= dict.fromkeys(found if name != "all" else (), text)
    return twin.at(positions).state


def listed_states(text: str) -> list[str]:
    """The `JOINT=VALUE` texts of a text, separated by commas; a name may have commas in it, no value has."""
    return [each.strip() for each in _LISTED.findall(text) if each.strip()]


def state_texts(twin: Twin) -> tuple[str, ...]:
    """The state of the twin as texts, for a process that loads its kitchen anew."""
    followers = twin.entities.coupling.followers
    free = (joint for joint in twin.state if joint not in followers)
    return tuple(f"{local_name(joint)}={twin.state[joint]!r}" for joint in free)


def named_motion(twin: Twin, motion: AnyMotion) -> AnyMotion:
    """The motion, of the joint or body that its name means where it is a name and no IRI.

    Raises:
        InputError: It is no motion, or has other values than arrays.
    """
    if not isinstance(motion, Motion | BodyMotion):
        raise InputError(
            f"a motion that is a {type(motion).__name__}",
            allowed="sdt_kg.motion's Motion (of a container) or BodyMotion (of a robot)",
            remedy="of services.motions, read_motion(path, twin, robot) reads one from a file, and "
            "motion_of(arrays, twin, robot) makes one of a dict",
        )
    lists = [name for name in ARRAYS if isinstance(getattr(motion, name, None), list | tuple)]
    if lists:
        raise InputError(f"'{lists[0]}' of a motion is a list", allowed="arrays", remedy="numpy.array(…)")
    for name in ARRAYS:
        array = getattr(motion, name, None)
        if array is not None and array.dtype.kind not in REAL:
            raise InputError(f"'{name}' of a motion is an array of {array.dtype}", allowed="of real numbers")
    if isinstance(motion, BodyMotion) or ":" in motion.of:
        return motion
    of = body_iri if motion.is_poses else joint_iri
    return replace(motion, of=of(twin.name(twin.environment), motion.of))


def state_joints(twin: Twin, texts: Sequence[str]) -> list[str]:
    """Those of the texts that name a joint or container of this kitchen (or `all`, or `asked`)."""
    known = named_joints(twin)
    return [text for text in texts if _name_in(text) in {*known, "all", ASKED}]


def state_of_asked(texts: Sequence[str], container: str) -> tuple[str, ...]:
    """The texts of a case about that container, which `asked` stands for: `asked=open`."""
    return tuple(
        f"{container}={text.partition('=')[2]}" if _name_in(text) == ASKED else text for text in texts
    )


def states_of_all(texts: Sequence[str]) -> tuple[str, ...]:
    """Those of the texts that are not about the container that is `asked` about."""
    return tuple(text for text in texts if _name_in(text) != ASKED)


def _name_in(text: str) -> str:
    return text.partition("=")[0].strip()


def parse_seeds(text: str) -> range:
    """Seeds of `7` or `0..9`.

    Raises:
        InputError: They are none, or too many.
    """
    first, _, last = text.partition("..")
    try:
        found = range(whole_in(first), whole_in(last or first) + 1)
    except ValueError:
        found = range(0)
    if not found:
        raise InputError(f"'{text}' is no seed and no range of seeds", allowed="7, or 0..9")
    if found[-1] - found[0] >= MOST_SEEDS:
        raise InputError(f"the seeds {text} are too many", allowed=f"up to {MOST_SEEDS}, as 0..9")
    return found


def parse_base(text: str | None) -> tuple[float, float, float] | None:
    """Base pose of `X,Y,YAW` [m, m, rad] in the kitchen's root frame."""
    if text is None:
        return None
    try:
        x, y, yaw = (number_in(part) for part in text.split(","))
    except ValueError:
        raise InputError(
            f"'{text}' is not a base pose", allowed="X,Y,YAW in m, m, rad, for example 0,0,1.57"
        ) from None
    if not all(math.isfinite(value) for value in (x, y, yaw)):
        raise InputError(f"'{text}' is not a base pose", allowed="finite numbers")
    return x, y, yaw


def parse_friction(text: str) -> float | None:
    """Coefficient of friction [1] of a text; None of an empty one.

    Raises:
        InputError: It is none with which fingers may rub.
    """
    if not text.strip():
        return None
    try:
        friction = number_in(text)
    except ValueError:
        friction = math.nan
    if not LEAST_FRICTION <= friction <= MOST_FRICTION:
        what = f"'{text}' is no coefficient of friction"
        raise InputError(what, allowed=f"{LEAST_FRICTION:g} to {MOST_FRICTION:g}")
    return friction


def _check_text(text: object, what: str, allowed: str) -> None:
    """What people type is text; from Python it may be anything."""
    if not isinstance(text, str):
        raise InputError(f"{what} that is a {type(text).__name__}", allowed=allowed)


def named_joints(twin: Twin) -> dict[str, Iri]:
    """Joint and container name → IRI of the joint that is set."""
    names = {local_name(joint): joint for joint in twin.state}
    return names | {container.name: container.active_joint for container in twin.containers()}


def _positions(twin: Twin, name: str, value: str) -> dict[Iri, float]:
    if name == "all":
        return _all_positions(twin, value)
    names = named_joints(twin)
    if name == ASKED:
        raise InputError(
            f"'{ASKED}={value}', and no container is asked about",
            allowed="CONTAINER=open|closed",
            remedy=f"sdt table and sdt sweep ask about one after the other, and take {ASKED}={value}",
        )
    if name not in names:
        kitchen = twin.name(twin.environment)
        remedy = f"sdt containers lists the containers of kitchen {kitchen}"
        raise UnknownEntityError("joint or container", name, names, remedy)
    joint = names[name]
    if value in {"open", "closed"}:
        matching = [each for each in twin.containers() if joint in {each.active_joint, each.joint}]
        if not matching:
            raise InputError(f"'{name}' is no container", allowed="a position for a joint, for example 0.2")
        # Of what moves together the one that is named: another may be open where this one is closed.
        named = next((each for each in matching if name in {each.name, local_name(each.joint)}), matching[0])
        return {named.active_joint: _active(named, value)}
    try:
        at = number_in(value)
    except ValueError:
        raise StateError(
            f"'{name}={value}' has no number",
            allowed="a position in rad or m, or of a container open or closed",
        ) from None
    led = twin.entities.coupling.followers.get(joint)
    return {joint: at} if led is None else {led.active: (at - led.offset) / led.multiplier}


def _all_positions(twin: Twin, value: str) -> dict[Iri, float]:
    if value in {"open", "closed"}:
        return {each.active_joint: _active(each, value) for each in _bounded(twin)}
    kind, _, seed = value.partition(":")
    if kind != "half-open" or not (seed.isdecimal() and seed.isascii()):
        raise InputError(f"'all={value}' is not a state", allowed="all=open, all=closed, all=half-open:SEED")
    draw = random.Random(int(seed))  # noqa: S311 - a test state, not a secret
    positions: dict[Iri, float] = {}
    for each in _bounded(twin):
        share = draw.uniform(HALF_OPEN_MARGIN, 1 - HALF_OPEN_MARGIN)
        own = each.closed_to + share * (each.open_from - each.closed_to)
        positions[each.active_joint] = (own - each.offset) / each.multiplier
    return positions


def _bounded(twin: Twin) -> list[Container]:
    """Containers with limits: one that turns round and round is never open or closed, and stays."""
    return [each for each in twin.containers() if math.isfinite(each.lower) and math.isfinite(each.upper)]


def _active(container: Container, value: str) -> float:
    """Position of the actuated joint at which the container's own joint is at its limit."""
    own = container.upper if value == "open" else container.lower
    if not math.isfinite(own):
        raise InputError(
            f"'{container.name}={value}' has no limit to be at", allowed="a position in rad or m"
        )
    return (own - container.offset) / container.multiplier
