"""The one place where parts are put together: twin, Φ, embodiment, Law.

`from services import load` is the public Python API.
"""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from pathlib import Path
from typing import Protocol, runtime_checkable

from predicates.case import Answer, Case, Verdict
from predicates.causes import causes_request
from predicates.law import law, stored_verdicts
from predicates.oracle import Embodiment, Physics
from predicates.record.recall import Recall, nothing_stored
from predicates.satisfies_request import satisfies_request
from sdt_kg.errors import InputError, QueryError
from sdt_kg.iri import Iri
from sdt_kg.load import load_twin
from sdt_kg.motion import BodyMotion, Motion
from sdt_kg.task import UNKNOWN, Task
from sdt_kg.twin import Twin
from services.certified import with_motion
from services.policy import DEFAULT_BUDGET, Policy
from services.requests import named_motion, parse_state, parse_task
from services.verdicts import Verdicts

__all__ = [
    "DEFAULT_BUDGET",
    "Forces",
    "KnowingForces",
    "Oracles",
    "Policy",
    "Service",
    "load",
    "whole_body",
]


class Oracles(Protocol):
    """Who answers for Φ and R in place of this process."""

    def physics(self) -> Physics:
        """Φ."""
        ...

    def embodiment(self, policy: Policy) -> Embodiment:
        """R under a policy."""
        ...


@runtime_checkable
class KnowingForces(Protocol):
    """Oracles that can be asked relative to D_artic_dyn."""

    def with_forces(self) -> Oracles:
        """The same oracles where forces count."""
        ...


@dataclass(frozen=True)
class Service:
    """The Law over one twin, asked with names as people type them.

    Attributes:
        twin: The kitchen in its present state, with the robots that were loaded.
        policy: What decides CanPerform beyond the case.
        recall: What is stored under a verdict's IRI, so that nothing is judged twice.
        oracles: Who answers for Φ and R; None: this process.
        handle_force: [N] What `with_forces` was told to allow at every handle, for kitchens that come later.
    """

    twin: Twin
    policy: Policy = field(default_factory=Policy)
    recall: Recall = nothing_stored
    oracles: Oracles | None = None
    handle_force: float | None = None

    def at(self, *states: str) -> "Service":
        """The same kitchen with these joints elsewhere: `JOINT=VALUE`, `all=open`, and so on."""
        return replace(self, twin=self.twin.at(parse_state(self.twin, states)))

    def with_forces(self, file: Path | None = None, handle_force: float | None = None) -> "Service":
        """The same relative to D_artic_dyn: a Φ with forces, and a robot that has to bear them.

        Args:
            file: Turtle that gives joints force models; None takes what the twin has, else what is
                bundled for its kitchen.
            handle_force: [N] Allowed at every handle instead of what the force models say.

        Raises:
            InputError: Other oracles answer that know no forces, or the force is none.
            AnnotationError: The file is no force data of this kitchen.
        """
        from services.dynamics.data import with_forces  # noqa: PLC0415 - only where forces are asked about

        twin = with_forces(self.twin, file, handle_force)
        return replace(self, twin=twin, oracles=self._forced(), handle_force=handle_force)

    def satisfies(self) -> Iterator[Answer]:
        """Every request which the present state meets: SatisfiesRequest, backwards."""
        return satisfies_request(Case(self.twin, final=self.twin.state))

    def causes(self, task: str | Task, motion: Motion | None = None) -> Iterator[Answer]:
        """Motions that would cause the task, or whether the given one does; no robot."""
        given = UNKNOWN if motion is None else named_motion(self.twin, motion)
        return causes_request(Case(self.twin, task=self._task(task), motion=given), self.physics)

    def achieve(
        self, task: str | Task, robot: str | Iri | None = None, motion: Motion | BodyMotion | None = None
    ) -> Verdicts:
        """CanAchieve: one verdict for each container that the task is about.

        A verdict that was stored comes with the body motion of its certificate. None is true or false: its
        `outcome` says which of three it is.

        Args:
            task: `open`, `open:CONTAINER`, `close` …
            robot: Name or IRI of a loaded robot; may be left out where only one is loaded.
            motion: To be verified; generated where it is None. What it is of may be a name.

        Raises:
            InputError: The motion is none.
        """
        case = self.case(task, robot, motion)
        return Verdicts(map(with_motion, law(case, self.physics, self.embodiment, self.recall)))

    def stored(self, task: str | Task, robot: str | Iri | None = None) -> list[Verdict] | None:
        """What `achieve` would say, if all of it is stored; else None, and nothing is judged."""
        found = stored_verdicts(self.case(task, robot), self.physics, self.embodiment, self.recall)
        return None if found is None else list(map(with_motion, found))

    def query(self, sparql: str) -> tuple[list[str], list[dict[str, object]]]:
        """Columns and rows of a SPARQL query over entities and present state.

        Raises:
            QueryError: It does not parse, would write or fetch, or has a FROM.
        """
        from services.store.guard import guarded  # noqa: PLC0415 - only where a query is asked

        if guarded(sparql, is_graph=lambda _: True).has_dataset:
            raise QueryError(
                "the query has a FROM, and a kitchen is asked as a whole",
                allowed="GRAPH ?g { … } for one of its graphs",
                remedy="leave FROM out",
            )
        return self.twin.query(sparql)

    def robot(self, name: str | Iri | None) -> Iri:
        """IRI of a loaded robot."""
        names = {self.twin.name(robot): robot for robot in self.twin.robots}
        if name is None and len(names) == 1:
            return next(iter(names.values()))
        if name in names:
            return names[name]
        if name in names.values():
            return str(name)
        what = "no robot is named" if name is None else f"no loaded robot '{name}'"
        raise InputError(
            what,
            allowed=", ".join(names) or "none is loaded",
            remedy="name it where the kitchen is loaded: --robot, or robots=[…] of load()",
        )

    @cached_property
    def physics(self) -> Physics:
        """Φ, in process unless there are other oracles."""
        if self.oracles is not None:
            return self.oracles.physics()
        from services.physics.oracle import Kinematics  # noqa: PLC0415 - not needed for questions about the graph

        return Kinematics()

    @cached_property
    def embodiment(self) -> Embodiment:
        """CanPerform's oracle, in process unless there are others."""
        if self.oracles is not None:
            return self.oracles.embodiment(self.policy)
        return whole_body(self.policy)

    def case(
        self, task: str | Task, robot: str | Iri | None, motion: Motion | BodyMotion | None = None
    ) -> Case:
        """What `achieve` asks the Law about.

        Raises:
            InputError: Any start is allowed, and there is no robot's motion: what is searched begins parked.
        """
        given = None if motion is None else named_motion(self.twin, motion)
        if self.policy.any_start and not isinstance(given, BodyMotion):
            raise InputError(
                "no robot's motion is given that may begin anywhere", remedy="leave any_start out"
            )
        case = Case(self.twin, robot=self.robot(robot), task=self._task(task))
        if isinstance(given, BodyMotion):
            return replace(case, body_motion=given)
        return case if given is None else replace(case, motion=given)

    def _forced(self) -> Oracles:
        if self.oracles is None:
            return Forces()
        if isinstance(self.oracles, KnowingForces):
            return self.oracles.with_forces()
        raise InputError("oracles elsewhere know no forces", allowed="D_artic_dyn in process")

    def _task(self, task: str | Task) -> Task:
        return task if isinstance(task, Task) else parse_task(self.twin, task)


@dataclass(frozen=True)
class Forces:
    """Who answers in process where forces count."""

    def physics(self) -> Physics:
        """Φ with forces."""
        from services.dynamics.oracle import Dynamics  # noqa: PLC0415 - only where forces are asked about

        return Dynamics()

    def embodiment(self, policy: Policy) -> Embodiment:
        """R that has to bear them."""
        from services.dynamics.robot.bearing import Bearing  # noqa: PLC0415 - only where forces are asked about

        # Forces are asked at a container's own handles: at those of others they are others. And let go on the
        # way, it might move.
        return Bearing(whole_body(policy, forces=True))


def whole_body(policy: Policy, *, forces: bool = False) -> Embodiment:
    """R of this process under a policy; where forces count, containers are held by their own handle, once."""
    from services.embodiment.oracle import WholeBody  # noqa: PLC0415 - not needed without a robot

    return WholeBody(
        drive=policy.drive,
        start=policy.base,
        budget=policy.budget,
        seed=policy.seed,
        any_start=policy.any_start,
        contact=policy.contact,
        friction=policy.friction,
        coupled=not forces,
        regrasps=not forces,
    )


def load(
    kitchen: str | Path,
    robots: Sequence[str | Path] = (),
    *,
    annotation: str | Path | None = None,
    state: Sequence[str] | Mapping[Iri, float] = (),
    policy: Policy | None = None,
) -> Service:
    """The Law over a kitchen, with robots, by bundled name or path of a URDF.

    Raises:
        InputError: `robots` or `state` is a single text, where there may be several.
        UnknownEntityError: No bundled kitchen or robot of that name, and no such file.
        UrdfError: A file that is not a valid URDF tree.
        AnnotationError: A robot's annotation is missing or contradicts its URDF.
    """
    for name, given in (("robots", robots), ("state", state)):
        if isinstance(given, str | Path):
            raise InputError(f"{name} is '{given}'", allowed="a list", remedy=f"{name}=['{given}']")
    twin = load_twin(kitchen, robots, annotation=annotation)
    service = Service(twin, policy or Policy())
    if isinstance(state, Mapping):
        return replace(service, twin=twin.at(state))
    return service.at(*state) if state else service
