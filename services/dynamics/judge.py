"""What forces make of a motion: causal failures, and where the parameters' intervals do not decide."""

from collections.abc import Iterator
from dataclasses import dataclass

from predicates.case import Diagnosis, Evidence, Kind, Quantity
from predicates.causes import STATE_TOLERANCE
from predicates.oracle import LET_GO
from predicates.scope import outside
from sdt_kg.iri import local_name
from sdt_kg.motion import Motion
from sdt_kg.numbers import told_apart
from sdt_kg.scope import D_ARTIC_DYN
from sdt_kg.shacl import Violation
from sdt_kg.twin import Container
from services.dynamics.model import Mechanics
from services.dynamics.need import Need, need
from services.dynamics.rest import Rest, at_rest, driven

AT_MOST = "handle force, at most"
"""The figure that bounds the force from above [N]."""
UNDECIDED = "https://example.org/tee/d_artic_dyn#ForceModelShape"
"""The shape whose intervals are too wide, or leave open what a verdict would have to claim."""


@dataclass(frozen=True, slots=True)
class Forced:
    """What Φ of D_artic_dyn finds about a motion beyond kinematics.

    Attributes:
        diagnoses: Causal failures and abstentions.
        notes: What a reader should know.
        figures: Bounds: name → (value, unit).
    """

    diagnoses: tuple[Diagnosis, ...]
    notes: tuple[str, ...]
    figures: dict[str, tuple[float, str]]


def forced(mechanics: Mechanics, container: Container, motion: Motion, off: float = 0.0) -> Forced:
    """Whether the force that τ needs is allowed, and whether the container stays before and after.

    Args:
        mechanics: Of the container.
        container: Which τ moves.
        motion: τ, as values of the container's own joint.
        off: How far from where τ begins the container is then [rad or m].
    """
    needed = need(mechanics, motion, off)
    begin = at_rest(mechanics, inside(mechanics, float(motion.values[0, 0]) + off))
    end = at_rest(mechanics, inside(mechanics, float(motion.values[-1, 0])))
    diagnoses = (
        *_too_much(mechanics, container, motion, needed),
        *_before(mechanics, container, begin),
        *_after(mechanics, container, motion, end),
    )
    allowed = mechanics.forces.allowed
    models = " and ".join(dict.fromkeys(local_name(each.mechanics.forces.iri) for each in mechanics.moving))
    how = "by monotonicity" if needed.monotone else "by interval bounds along the motion"
    notes = (
        f"{D_ARTIC_DYN.name}: the largest force at the handle, along its path, is between "
        f"{_told(needed.least, allowed)} and {_told(needed.most, allowed)}, {allowed:g} N allowed: {how}, "
        f"for every value of force model {models}",
    )
    figures = {
        AT_MOST: (needed.most, "N"),
        "handle force, at least": (needed.least, "N"),
        "handle force, allowed": (allowed, "N"),
    }
    if not end.stays:
        notes += (f"when let go {container.name} moves {way(end)}, or may",)
        figures[LET_GO] = (end.pull, mechanics.unit)
    return Forced(diagnoses, notes, figures)


def _told(force: float, allowed: float) -> str:
    """A force, with as many digits as tell it from what is allowed."""
    return f"{told_apart(force, allowed, 1, 'f')[0]} N"


def inside(mechanics: Mechanics, q: float) -> float:
    return min(max(q, mechanics.lower), mechanics.upper)


def _too_much(
    mechanics: Mechanics, container: Container, motion: Motion, needed: Need
) -> Iterator[Diagnosis]:
    """More force than is allowed: needed by every value, or by some.

    A motion whose times are only proposed may be made slower, so that against it only what leaving
    rest needs is proof.
    """
    allowed = mechanics.forces.allowed
    if needed.least > allowed:
        verb = "opens" if motion.values[-1, 0] >= motion.values[0, 0] else "closes"
        reason = (
            f"{container.name} {verb}, but needs {_told(needed.least, allowed)} where {allowed:g} N is "
            f"allowed, at {needed.least_time:.3f} s"
        )
        evidence = Evidence(
            Quantity.FORCE, needed.least, allowed, "N", entity=container.handle, time=needed.least_time
        )
        proof = motion.timed or needed.onset > allowed
        yield Diagnosis(Kind.CAUSAL, reason, evidence, proof=proof)
    elif needed.most > allowed:
        what = (
            f"the intervals leave open whether {container.name} needs more than {allowed:g} N: "
            f"its largest force is between {_told(needed.least, allowed)} and {_told(needed.most, allowed)}; "
            "narrow them by measuring"
        )
        evidence = Evidence(
            Quantity.FORCE, needed.most, allowed, "N", entity=container.handle, time=needed.most_time
        )
        yield left_open(mechanics, what, evidence)


def _before(mechanics: Mechanics, container: Container, rest: Rest) -> Iterator[Diagnosis]:
    """The state in which it begins is one of rest."""
    if not rest.stays:
        what = f"{container.name} does not surely stay where it begins: it moves {way(rest)}, or may"
        yield left_open(mechanics, what, pull(mechanics, rest))


def _after(mechanics: Mechanics, container: Container, motion: Motion, rest: Rest) -> Iterator[Diagnosis]:
    """What it does when let go does not undo what was achieved: further open than open does no harm."""
    q = float(motion.values[-1, 0])
    harmless = (not rest.shuts or container.is_closed(q)) and (not rest.opens or container.is_open(q))
    if rest.stays or harmless:
        return
    where = f"{container.name} let go at {q:.3g}"
    drives = f"{rest.pull:.1f} {mechanics.unit} {{}} friction of {rest.friction:.1f} {mechanics.unit}"
    if rest.surely and driven(mechanics, q, _undone_at(container, q, rest), shut=rest.shuts):
        reason = f"{where} does not stay: it moves {way(rest)}, " + drives.format("against")
        yield Diagnosis(Kind.CAUSAL, reason, pull(mechanics, rest), proof=motion.timed)
    else:
        what = f"{where} may move {way(rest)}: up to " + drives.format("against a least")
        yield left_open(mechanics, what, pull(mechanics, rest))


def _undone_at(container: Container, q: float, rest: Rest) -> float:
    """Where what was achieved at q is undone on the way that it takes when let go."""
    if rest.shuts:
        return container.open_from if container.is_open(q) else q - STATE_TOLERANCE
    return container.closed_to if container.is_closed(q) else q + STATE_TOLERANCE


def way(rest: Rest) -> str:
    return "either way" if rest.shuts and rest.opens else ("shut" if rest.shuts else "further open")


def pull(mechanics: Mechanics, rest: Rest) -> Evidence:
    return Evidence(Quantity.FORCE, rest.pull, rest.friction, mechanics.unit, entity=mechanics.joint)


def left_open(mechanics: Mechanics, what: str, evidence: Evidence) -> Diagnosis:
    """An abstention: I_Φ holds values for which the verdict would differ."""
    violation = Violation(mechanics.forces.iri, None, evidence.value, evidence.bound, what, UNDECIDED)
    found = outside(violation, D_ARTIC_DYN)
    return Diagnosis(found.kind, f"outside {D_ARTIC_DYN.name}: {what}", evidence, violation=violation)
