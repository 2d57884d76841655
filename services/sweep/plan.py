"""Which cases: every combination of what is varied, kitchen by kitchen, as workers keep what they load."""

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, field
from itertools import product
from math import prod
from pathlib import Path
from typing import TypeVar

from predicates.meant import counted
from sdt_kg.annotation import Drive
from sdt_kg.errors import InputError, UnknownEntityError
from sdt_kg.load import model_name, model_path
from sdt_kg.task import Verb
from sdt_kg.twin import Twin
from services.app import DEFAULT_BUDGET, Policy
from services.relative import KINEMATIC, Relative, tee_of
from services.requests import parse_state, parse_task, state_joints, state_of_asked
from services.sweep.cell import Cell
from services.sweep.worker import kitchen_of

T = TypeVar("T")
Base = tuple[float, float, float]
States = tuple[str, ...]


@dataclass(frozen=True, slots=True)
class Axes:
    """What is varied in every kitchen.

    Attributes:
        tasks: `open`, `close` for every container, or `open:CONTAINER`.
        states: `JOINT=VALUE` texts of each start state; the empty one is everything closed. `asked` stands
            for the container of each case.
        policies: Drive, base pose, friction, budget and seed.
        classes: That verdicts are relative to.
    """

    tasks: tuple[str, ...] = ("open",)
    states: tuple[States, ...] = ((),)
    policies: tuple[Policy, ...] = (Policy(),)
    classes: tuple[Relative, ...] = (KINEMATIC,)


@dataclass(frozen=True, slots=True)
class Models:
    """What a kitchen can be swept over: names of its robots and containers."""

    kitchen: str
    robots: tuple[str, ...]
    containers: tuple[str, ...]


@dataclass(frozen=True, slots=True)
class Plan:
    """Cases that are counted before the first is made; they can be gone through again.

    Attributes:
        total: How many.
        cells: In the order in which they are handed out.
    """

    total: int
    cells: Iterable[Cell]


@dataclass(frozen=True, slots=True)
class Combined:
    """Every combination in one kitchen; made one by one, a million of them are no list."""

    kitchen: str
    robots: tuple[str, ...]
    axes: Axes

    def __len__(self) -> int:
        axes = self.axes
        varied = (self.robots, axes.states, axes.policies, axes.classes, axes.tasks)
        return prod(map(len, varied))

    def __iter__(self) -> Iterator[Cell]:
        """The kitchen's cases; those that follow each other have the same robot, state and policy."""
        axes = self.axes
        loaded = product(self.robots, axes.classes, axes.states, axes.policies)
        for (robot, relative, states, policy), task in product(loaded, axes.tasks):
            yield cell_about(self.kitchen, robot, task, states, policy, relative)


def cell_about(  # noqa: PLR0913, PLR0917  # the parts of a case
    kitchen: str, robot: str, task: str, states: States, policy: Policy, relative: Relative
) -> Cell:
    """A case, `asked` in its states being the container of its task."""
    own = state_of_asked(states, task.partition(":")[2])
    return Cell(kitchen, robot, task, own, policy, relative)


@dataclass(frozen=True, slots=True)
class _Chained:
    parts: tuple[Combined, ...]

    def __iter__(self) -> Iterator[Cell]:
        for part in self.parts:
            yield from part


def combined(models: Models, axes: Axes) -> Combined:
    """Every robot, state, policy and task of one kitchen; a task without a container is about each.

    Raises:
        UnknownEntityError: A task names a container that the kitchen has not.
        InputError: A task is none of D_artic's.
    """
    tasks: list[str] = []
    for text in axes.tasks:
        verb, _, name = text.partition(":")
        if verb not in {each.value for each in Verb}:
            allowed = ", ".join(f"{each.value}[:CONTAINER]" for each in Verb)
            raise InputError(f"no task type '{verb}'", allowed=allowed)
        if name and name not in models.containers:
            raise UnknownEntityError("container", name, models.containers)
        tasks += [f"{verb}:{each}" for each in ([name] if name else models.containers)]
    varied = Axes(_once(tasks), _once(axes.states), _once(axes.policies), _once(axes.classes))
    return Combined(models.kitchen, models.robots, varied)


def grid(kitchens: Sequence[str], robots: Sequence[str], axes: Axes) -> Plan:
    """Every combination in every kitchen.

    A state text or task that names a joint or container applies to those kitchens which have it.

    Raises:
        InputError: Two models share a name, or no kitchen has a joint or container that is named.
        UnknownEntityError: A model that is not there.
    """
    known = Known()
    known.check_robots(robots)
    check_names(kitchens)
    parts = tuple(_part(known.twin(kitchen), kitchen, tuple(robots), axes) for kitchen in kitchens)
    _all_used(
        {text for states in axes.states for text in states},
        (text for part in parts for states in part.axes.states for text in states),
        "joint",
    )
    _all_used(
        {text for text in axes.tasks if ":" in text},
        (text for part in parts for text in part.axes.tasks),
        "container",
    )
    return Plan(sum(map(len, parts)), _Chained(parts))


def policies(
    drives: Sequence[Drive | None] = (None,),
    bases: Sequence[Base | None] = (None,),
    seeds: Sequence[int] = (0,),
    budget: float = DEFAULT_BUDGET,
    frictions: Sequence[float | None] = (None,),
) -> tuple[Policy, ...]:
    """Every combination of these."""
    return tuple(
        Policy(drive, base, budget, seed, friction=friction)
        for drive, base, friction, seed in product(drives, bases, frictions, seeds)
    )


def classes(
    tees: Sequence[str], forces: Path | None = None, handle_forces: Sequence[float] = ()
) -> tuple[Relative, ...]:
    """Each class; those that know forces with each force that is allowed.

    Raises:
        InputError: Forces, and no class that knows any.
        UnknownEntityError: There is no class of that name.
    """
    named = [tee_of(each) for each in tees]
    allowed = handle_forces or (None,)
    if "d_artic_dyn" not in named:
        return (Relative("d_artic", forces, allowed[0]),)
    forced = tuple(Relative("d_artic_dyn", forces, each) for each in allowed)
    return tuple(each for tee in named for each in (forced if tee == "d_artic_dyn" else (KINEMATIC,)))


@dataclass(slots=True)
class Known:
    """What was loaded to check cases against; each kitchen once, without robots."""

    _twins: dict[str, Twin] = field(default_factory=dict[str, Twin])
    _checked: set[tuple[str, ...]] = field(default_factory=set[tuple[str, ...]])

    def twin(self, kitchen: str) -> Twin:
        """The kitchen.

        Raises:
            UnknownEntityError, InputError: It is not there, or not valid.
        """
        if kitchen not in self._twins:
            self._twins[kitchen] = kitchen_of(kitchen)
        return self._twins[kitchen]

    @staticmethod
    def check_robots(robots: Sequence[str]) -> None:
        """Each robot is there.

        Raises:
            UnknownEntityError: One is not.
            InputError: Two have the same name.
        """
        check_names(robots)
        for robot in robots:
            model_path("robot", robot)

    def check(self, cell: Cell) -> None:
        """The kitchen has the container and the joints that the case names.

        Raises:
            InputError: It has not; the nearest names are told.
        """
        twin = self.twin(cell.kitchen)
        checks = {
            ("robot", cell.robot): lambda: model_path("robot", cell.robot),
            ("task", cell.kitchen, cell.task): lambda: parse_task(twin, cell.task),
            ("state", cell.kitchen, *cell.states): lambda: parse_state(twin, cell.states),
        }
        for key, check in checks.items():
            if key not in self._checked:
                check()
                self._checked.add(key)


def check_names(models: Sequence[str]) -> None:
    """No two models have the same name: they would be one in the graph.

    Raises:
        InputError: Two have.
    """
    names = [model_name(model) for model in models]
    if len(set(names)) < len(names):
        raise InputError(f"two models share a name: {', '.join(names)}", allowed="each model once")


def _part(twin: Twin, kitchen: str, robots: tuple[str, ...], axes: Axes) -> Combined:
    # Doors take longest: begun last, they would keep one worker busy while the others have nothing.
    ordered = sorted(counted(twin), key=lambda container: container.kind != "door")
    containers = tuple(container.name for container in ordered)
    here = tuple(text for text in axes.tasks if ":" not in text or text.partition(":")[2] in containers)
    states = tuple(tuple(state_joints(twin, texts)) for texts in axes.states)
    for texts, name in product(states, containers):
        parse_state(twin, state_of_asked(texts, name))
    varied = Axes(here, states, axes.policies, axes.classes)
    return combined(Models(kitchen, robots, containers), varied)


def _all_used(given: set[str], used: Iterable[str], what: str) -> None:
    unused = given - set(used)
    if unused:
        raise InputError(f"no kitchen of these has a {what} for: {', '.join(sorted(unused))}")


def _once(values: Iterable[T]) -> tuple[T, ...]:
    return tuple(dict.fromkeys(values))
