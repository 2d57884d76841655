"""CanPerform (Eq. 7) of D_artic_dyn: the robot performs the motion, and bears the force that it takes."""

from collections.abc import Callable
from dataclasses import replace
from functools import partial

from predicates.case import Answer, Case, Diagnosis, Kind
from predicates.meant import moved_by
from predicates.oracle import Embodiment
from predicates.scope import outside
from sdt_kg.errors import OracleRejectedError
from sdt_kg.iri import Iri, local_name
from sdt_kg.motion import BodyMotion, Motion
from sdt_kg.numbers import told_apart
from sdt_kg.scope import D_ARTIC_DYN
from sdt_kg.shacl import Violation
from sdt_kg.twin import Container, Twin
from services.dynamics.cells import Cells, cells, instants
from services.dynamics.oracle import Dynamics
from services.dynamics.robot.checks import Bound, Checks, checks
from services.dynamics.robot.load import Loads, loads
from services.embodiment.certify.held.friction import slanted
from services.physics.model import Scene
from services.versions import bearing

BOUNDED = "forces of the robot are bounded between samples too; its hand is taken to pull along the path"

PARTS = (2, 8, 32, 128)
"""[1] Into how many spans each piece of the motion is cut, until they decide."""

UNDECIDED = "https://example.org/tee/d_artic_dyn#ForceModelShape"
"""The shape whose intervals are too wide for this robot."""


class Bearing:
    """The Embodiment protocol on top of another: what that finds must also be borne.

    Attributes:
        inner: Who finds and certifies body motions.
    """

    def __init__(self, inner: Embodiment) -> None:
        self.inner, self._dynamics = inner, Dynamics()

    @property
    def version(self) -> str:
        return bearing(self.inner.version)

    def settings(self, twin: Twin, robot: Iri) -> tuple[tuple[str, str], ...]:
        return self.inner.settings(twin, robot)

    def perform(self, case: Case) -> Answer:
        answer = self.inner.perform(case)
        body = answer.case.body_motion
        if not answer.holds or not isinstance(body, BodyMotion) or not isinstance(case.robot, str):
            return answer
        return self._borne(answer, body, case.robot, _container(answer.case))

    def _borne(self, answer: Answer, body: BodyMotion, robot: Iri, container: Container) -> Answer:
        """The answer, refused or left open where the robot does not surely bear the force."""
        twin = answer.case.twin
        scene = Scene(twin, robot)
        mechanics = self._dynamics.mechanics(twin, container)
        carried = self._dynamics.carried(twin, body, container)
        asked = checks(scene, twin, body.gripper, _slant(answer))
        off = twin.state[container.joint] - float(carried.values[0, 0])
        bounds = _decided(asked, partial(loads, scene, body, mechanics), carried, off) if asked.of else []
        found = [each for bound in bounds for each in _judged(bound, mechanics.forces.iri)]
        refusals = tuple(each for each in found if each.kind is Kind.EMBODIMENT)
        figures = answer.figures | _nearest(bounds)
        notes = (*answer.notes, *asked.missing, *((BOUNDED,) if asked.of else ()))
        diagnoses = refusals or tuple(found)
        if not diagnoses:
            return replace(answer, notes=notes, figures=figures)
        case = replace(answer.case, body_motion=body)
        refused = replace(answer, case=case, holds=False, diagnoses=diagnoses, notes=notes)
        return replace(refused, figures={}, artefact=None, nearest_pairs={})


def _slant(answer: Answer) -> float | None:
    """How far faces that hold look away from the way in which fingers close [rad], where a certificate is."""
    return None if answer.artefact is None else slanted(answer.figures)


def _decided(asked: Checks, loaded: Callable[[Cells], Loads], carried: Motion, off: float) -> list[Bound]:
    """Of every check, over spans so short that they decide; of those alone that none will, if there are.

    The container is `off` from where the motion begins, then.
    """
    bounds = list[Bound]()
    for parts in PARTS:
        bounds = asked.bounds(loaded(cells(carried, parts, off)))
        if all(each.decided for each in bounds):
            break
        if parts == PARTS[0]:
            here = zip(bounds, asked.bounds(loaded(instants(carried, off))), strict=True)
            broken = [replace(over, least=at.least) for over, at in here if at.most > at.bound]
            if broken:
                return broken
    return bounds


def _judged(bound: Bound, forces: Iri) -> list[Diagnosis]:
    """Nothing if it is kept; a refusal if no value keeps it; else an abstention."""
    if bound.most <= bound.bound:
        return []
    if bound.least > bound.farthest:
        least, _ = told_apart(bound.least, bound.farthest, 1, "f")
        reason = (
            f"{bound.name} is {least} {bound.unit} or more in the motion that was found, "
            f"{bound.farthest:g} {bound.unit} allowed; another motion may ask less"
        )
        return [Diagnosis(Kind.EMBODIMENT, reason, bound.evidence(bound.least, bound.farthest))]
    least, most = (told_apart(each, bound.bound, 1, "f")[0] for each in (bound.least, bound.most))
    what = (
        f"the intervals leave open whether the robot bears it: {bound.name} is between {least} "
        f"and {most} {bound.unit}, {bound.bound:g} {bound.unit} surely allowed"
    )
    violation = Violation(forces, None, bound.most, bound.bound, what, UNDECIDED)
    found = outside(violation, D_ARTIC_DYN)
    return [
        replace(
            found,
            reason=f"outside {D_ARTIC_DYN.name}: {what}",
            evidence=bound.evidence(bound.most, bound.bound),
        )
    ]


def _nearest(bounds: list[Bound]) -> dict[str, tuple[float, str]]:
    """The bound that is used most, as shares of it; bounds of 0 by their distance."""
    shares = [(each.most / each.bound, each) for each in bounds if each.bound > 0]
    if not shares:
        return {}
    share, nearest = max(shares, key=lambda each: each[0])
    return {f"share of {nearest.name} that is used": (share, "1")}


def _container(case: Case) -> Container:
    if not isinstance(case.motion, Motion):
        raise OracleRejectedError("CanPerform of D_artic_dyn was asked without a motion of a container")
    moved = moved_by(case.twin, case.motion.of)
    if not moved:
        raise OracleRejectedError(f"{local_name(case.motion.of)} moves no container")
    return moved[0]
