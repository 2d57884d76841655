"""What a worker does with a case; what is loaded once is kept for the cases that follow."""

import logging
import threading
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager, suppress
from dataclasses import dataclass, replace
from functools import cached_property, lru_cache, partial
from importlib import import_module
from pathlib import Path

import pyoxigraph as ox

from predicates.case import Verdict
from predicates.oracle import Embodiment, Physics
from predicates.questions import questions
from predicates.record import to_json, to_record
from predicates.record.inputs import inputs_of, verdict_iri
from predicates.record.recall import Recall
from predicates.scope import verb_iri
from sdt_kg.entities import Entities
from sdt_kg.errors import SdtError
from sdt_kg.iri import SDT, Iri, model_iri
from sdt_kg.load import GRAPH_FORMATS, load_twin, model_name, with_robot
from sdt_kg.mechanism import Body, JointType, Mechanism, Pose
from sdt_kg.scope import Seen, look, look_at_robot, remember, violations
from sdt_kg.store import Triple
from sdt_kg.task import Verb
from sdt_kg.triples import mechanism_triples
from sdt_kg.triples.from_mechanism import pose_triples
from sdt_kg.twin import Twin
from services.app import Forces, Oracles, Policy, Service, whole_body
from services.garbage import unsought
from services.keeping.robots import read_robot
from services.relative import Relative
from services.sweep.ahead import reading
from services.sweep.cell import Cell, CellResult, Found, Unjudged

TWINS_KEPT = 16
"""Kitchens with a robot that a worker keeps."""
OF_OTHERS = "its worker has other models, or another version: start it again"
"""Why there is no verdict though a worker gave one."""
SERVICES_KEPT = 8
"""Combinations of kitchen, robot, state and policy whose scenes a worker keeps."""


@dataclass(frozen=True, slots=True)
class Written:
    """A model's name or path, and when its files were written [ns]."""

    name: str
    times: tuple[int, ...]


_turn = threading.Lock()
_log = logging.getLogger("sdt.sweep")


def judge(cell: Cell) -> Found:
    """The verdict about the case; a worker with several threads judges one case at a time."""
    with _turn:
        try:
            verdict = verdict_of(cell)
            return CellResult(cell, to_json(verdict), to_record(verdict))
        except SdtError as error:
            return Unjudged(cell, str(error))
        except Exception:  # noqa: BLE001 - the edge of a worker: logged, and answered as a failure
            _log.exception("%s could not be judged", cell)
            return Unjudged(cell, "the case could not be judged; the worker's log says why")


def prepare(cell: Cell) -> None:
    """What every case needs is loaded: workers that begin as copies of this process have it then.

    What cannot be loaded is told by the case.
    """
    from services.embodiment.oracle import WholeBody  # noqa: PLC0415 - a sweep that finds all stored needs none

    remember_looks()
    with suppress(SdtError):
        service, robot = service_of(cell), robot_of(cell)
        next(service.causes(cell.task), None)
        # What shapes say of a robot is kept for all containers.
        violations(service.twin, service.twin.container(cell.container), robot, verb_iri(cell.verb))
        if isinstance(service.embodiment, WholeBody):
            service.embodiment.prepare(service.twin, robot)


def prepare_robot(cell: Cell) -> None:
    """What the robot needs in any kitchen is loaded: its shapes and compiled loops.

    It stands in an empty room for that. What cannot be loaded is told by the case.
    """
    from services.embodiment.oracle import WholeBody  # noqa: PLC0415 - see above

    with suppress(SdtError):
        if isinstance(body := service_of(cell).embodiment, WholeBody):
            twin = with_robot(_empty_room(), _robot(_written(cell.robot)))
            body.prepare(twin, twin.robots[0])


@lru_cache(maxsize=1)
def _empty_room() -> Twin:
    room, iri = Mechanism("empty_room", "room", (Body("room"),), ()), model_iri("empty_room")
    start: Triple = (iri, SDT + "startPose", ox.NamedNode(f"{iri}/start"))
    triples = (*mechanism_triples(room, "Environment"), start, *pose_triples(f"{iri}/start", Pose()))
    return Twin(Entities.alone(iri, triples))


def dear_first(cells: Sequence[Cell]) -> list[Cell]:
    """The cases, those first that are expected to take longest: begun last, one keeps a worker busy alone.

    Doors take longer than drawers, and robots of few joints, which have few ways to follow, longer than
    others. Where there is more to load than a worker keeps, the order stays: it would be loaded twice.
    """
    if len({cell.loaded for cell in cells}) > SERVICES_KEPT:
        return list(cells)
    return sorted(cells, key=_ease)


def _ease(cell: Cell) -> tuple[bool, int]:
    service = service_of(cell)
    joints = service.twin.mechanism(robot_of(cell)).joints
    movable = sum(joint.type is not JointType.FIXED for joint in joints)
    return service.twin.container(cell.container).kind != "door", movable


def verdict_of(cell: Cell) -> Verdict:
    """CanAchieve of the case's one container."""
    (verdict,) = service_of(cell).achieve(cell.task, robot_of(cell))
    return verdict


def stored(cell: Cell, recall: Recall) -> CellResult | None:
    """The verdict that is kept of the case, found by the hash of all its inputs; None: judge it."""
    verdict = stored_verdict(cell, recall)
    return None if verdict is None else CellResult(cell, to_json(verdict), to_record(verdict))


def stored_verdict(cell: Cell, recall: Recall) -> Verdict | None:
    """The same, as a value."""
    verdicts = replace(service_of(cell), recall=recall).stored(cell.task, robot_of(cell))
    return None if verdicts is None else verdicts[0]


def as_asked(found: Found) -> Found:
    """What a worker elsewhere found, if it is about what is asked here; else no verdict.

    It may have read other files at the same paths, or be of another version.
    """
    if not isinstance(found, CellResult):
        return found
    service = service_of(found.cell)
    asked_here = service.case(found.cell.task, robot_of(found.cell))
    (question,) = questions(asked_here, service.physics, service.embodiment)
    asked = verdict_iri(inputs_of(question.asked, service.physics, service.embodiment))
    return found if found.record.verdict == asked else Unjudged(found.cell, OF_OTHERS)


def service_of(cell: Cell) -> Service:
    """The Law over the case's kitchen with its robot, in its state and under its policy."""
    kitchen, robot, *rest = cell.loaded
    return _service(_written(kitchen), _written(robot), *rest)


def robot_of(cell: Cell) -> Iri:
    """The case's robot: a kitchen that was saved may have others, too."""
    return service_of(cell).robot(model_name(cell.robot))


@lru_cache(maxsize=SERVICES_KEPT)
def _service(
    kitchen: Written, robot: Written, states: tuple[str, ...], policy: Policy, relative: Relative
) -> Service:
    service = replace(_in_class(kitchen, robot, relative), policy=policy)
    return service.at(*states) if states else service


@lru_cache(maxsize=TWINS_KEPT)
def _in_class(kitchen: Written, robot: Written, relative: Relative) -> Service:
    return relative.of(Service(_twin(kitchen, robot), oracles=_here()))


def twin_of(kitchen: str, robot: str) -> Twin:
    """The kitchen with that robot.

    Raises:
        InputError: They cannot be loaded.
    """
    return _twin(_written(kitchen), _written(robot))


@lru_cache(maxsize=TWINS_KEPT)
def _twin(kitchen: Written, robot: Written) -> Twin:
    twin, name = _kitchen(kitchen), model_name(robot.name)
    is_there = any(twin.name(each) == name for each in twin.robots)  # a kitchen that was saved has robots
    return twin if is_there else with_robot(twin, _robot(robot))


def kitchen_of(kitchen: str) -> Twin:
    """The kitchen without robots.

    Raises:
        InputError: It cannot be loaded.
    """
    return _kitchen(_written(kitchen))


@lru_cache(maxsize=TWINS_KEPT)
def _robot(robot: Written) -> Entities:
    return read_robot(robot.name)


@contextmanager
def reading_ahead(kitchens: Sequence[str], robots: Sequence[str], verb: Verb) -> Iterator[None]:
    """Another process reads the kitchens and looks at all scope, while this one loads oracles and robots.

    What cannot be read is told when it is asked for. What is seen counts from `remember_looks` on.
    """
    written = {_written(name): name for name in kitchens if Path(name).suffix not in GRAPH_FORMATS}
    looks = partial(look, verb=verb_iri(verb)), partial(_look_at_robots, robots)
    with reading(list(written.values()), load_twin, *looks) as ahead:
        with unsought(for_good=True):
            for name in ("services.physics.oracle", "services.embodiment.oracle"):
                import_module(name)
            with suppress(SdtError):
                for robot in robots:
                    _robot(_written(robot))
        found = ahead.kitchens()
        _ahead.update({each: found[name] for each, name in written.items() if name in found})
        _looks.append(ahead.seen)
        try:
            yield
        finally:
            _looks.clear()


def _look_at_robots(robots: Sequence[str]) -> Seen:
    """What shapes say of those that can be read."""
    seen: Seen = {}
    for robot in robots:
        with suppress(SdtError):  # who needs it is told
            seen |= look_at_robot(_robot(_written(robot)))
    return seen


_looks: list[Callable[[], Seen]] = []
"""What another process sees of kitchens and robots, until it is waited for."""


def remember_looks() -> None:
    """What another process sees of kitchens and robots is not looked at here; waits for it."""
    while _looks:
        remember(_looks.pop()())


_ahead: dict[Written, Twin] = {}
"""Kitchens that were read ahead, as they were written then, until they are asked for."""


@lru_cache(maxsize=TWINS_KEPT)
def _kitchen(kitchen: Written) -> Twin:
    twin = _ahead.pop(kitchen, None) or load_twin(kitchen.name)
    twin.content_hash(twin.environment)  # what is read here, twins with robots need not read again
    return twin


def _written(name: str) -> Written:
    """The model as its files are now: one that was edited since is loaded again."""
    path = Path(name)
    files = (path, path.with_suffix(".ttl")) if path.name else ()  # "/" and "" have none, and are no models
    return Written(name, tuple(each.stat().st_mtime_ns for each in files if each.is_file()))


class _Here:
    """The oracles of this process: what Φ finds out about a kitchen counts for all its robots."""

    def physics(self) -> Physics:
        """The same Φ each time."""
        return self._kinematics

    def embodiment(self, policy: Policy) -> Embodiment:
        """R, which keeps the scenes of one robot."""
        return whole_body(policy)

    def with_forces(self) -> Oracles:
        """Those where forces count."""
        return Forces()

    @cached_property
    def _kinematics(self) -> Physics:
        from services.physics.oracle import Kinematics  # noqa: PLC0415 - a sweep that finds all stored needs none

        return Kinematics()


@lru_cache(maxsize=1)
def _here() -> _Here:
    return _Here()
