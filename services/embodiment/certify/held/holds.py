"""All holds of a container along a motion: one, or several, each anew while it rests.

Where no gripper is named, another may take over: it comes to the handle once the one before has left it.
"""

from collections.abc import Iterator, Sequence
from itertools import chain, islice

from predicates.case import Evidence, Quantity
from sdt_kg.annotation import Gripper
from sdt_kg.errors import UnknownEntityError
from sdt_kg.twin import Container
from services.embodiment.certify.findings import Findings, Violation
from services.embodiment.certify.held.hold import Hold
from services.embodiment.certify.held.stints import begin
from services.embodiment.certify.sweep.kinematics import unit_of
from services.embodiment.certify.sweep.subject import Subject

HOLDS = "holds"
"""Name of the figure that says how many there are, where there are more than one."""

Found = tuple[list[Hold], Findings]


def held_so(
    checked: Subject, container: Container, name: str, *, one_hold: str = "", in_full: bool = False
) -> Found:
    """How the named gripper holds the container; if none is named, any, first the one that does so best.

    Args:
        checked: The motion.
        container: What is held, by its handle.
        name: Of the gripper; empty if none is named.
        one_hold: Why it must not be let go before it stops for good; empty if it may.
        in_full: Whether what follows a grasp that comes too late is judged as well.

    Raises:
        UnknownEntityError: There is no such gripper.
    """
    grippers = {gripper.name: gripper for gripper in checked.scene.annotation.grippers}
    if name and name not in grippers:
        raise UnknownEntityError("gripper", name, grippers)
    first = begin(checked.pieces, checked.scene.coordinate[container.joint])
    if first is None:
        return [], Findings()
    chosen = [grippers[name]] if name else list(grippers.values())
    ways = [_taken(checked, container, first_of(gripper, chosen), first) for gripper in chosen]
    holds, findings = min(ways, key=_badness)
    if findings.violations:
        failed = [holds.pop(), *(() if holds else (other[-1] for other, _ in ways if other))]
        lates = (one.later() for one in failed) if in_full else ()
        holds += islice((late for late in lates if late is not None), 1)
    for hold in holds:
        _add(findings, hold.follows())
        _add(findings, hold.keeps_fingers())
    findings.nearest = [*dict.fromkeys(findings.nearest), *let_go(holds)]
    if len(holds) > 1:
        findings.figures[HOLDS] = (float(len(holds)), "1")
        if one_hold:
            findings.violations.append(_let_go_too_soon(holds[0], one_hold))
    return holds, findings


def first_of(gripper: Gripper, grippers: Sequence[Gripper]) -> list[Gripper]:
    """These grippers, one of them first."""
    return [gripper, *(one for one in grippers if one.name != gripper.name)]


def _taken(checked: Subject, container: Container, grippers: Sequence[Gripper], first: int) -> Found:
    """The holds one after the other, up to the first grasp that is none."""
    holds, findings = list[Hold](), Findings()
    for hold in one_after_the_other(checked, container, grippers, first):
        holds.append(hold)
        _add(findings, hold.contact)
        if findings.violations:
            break
    return holds, findings


def one_after_the_other(
    checked: Subject, container: Container, grippers: Sequence[Gripper], first: int
) -> Iterator[Hold]:
    """The holds of a container that begins to move on a piece, whether they are any or not.

    The first is by the first of these grippers; who holds it later holds it anew, or any other takes over.
    """
    hold = Hold(checked, container, grippers[0], first)
    yield hold
    while hold.onward is not None:
        hold = _anew(hold, grippers, hold.onward)
        yield hold


def _anew(hold: Hold, grippers: Sequence[Gripper], onward: int) -> Hold:
    """The next hold: by the same gripper, if it holds then or no other does, else by another."""
    about, since = (hold.checked, hold.container), hold.left + 1
    each = (Hold(*about, one, onward, since) for one in first_of(hold.gripper, grippers))
    same = next(each)
    return next((one for one in chain((same,), each) if not one.contact.violations), same)


def _badness(found: Found) -> tuple[bool, int, float]:
    """Less where it is held all along, or else in more holds, or one that is more nearly so."""
    holds, findings = found
    worst = max((each.excess for each in findings.violations), default=0.0)
    return bool(findings.violations), -len(holds) if findings.violations else 0, worst


def _add(findings: Findings, more: Findings) -> None:
    """The same of one more hold: of figures that two have, which are all of errors, the larger."""
    most = {
        name: max(findings.figures[name], figure)
        for name, figure in more.figures.items()
        if name in findings.figures
    }
    findings.add(more)
    findings.figures.update(most)


def _let_go_too_soon(hold: Hold, why: str) -> Violation:
    scene, pieces, joint = hold.scene, hold.checked.pieces, hold.container.joint
    k, unit = scene.coordinate[joint], unit_of(scene, scene.coordinate[joint])
    here, end = float(pieces.c[0, hold.last + 1, k]), float(pieces.end[k])
    reason = f"{hold.container.name} is let go at {here:.4g} {unit}, before it stops for good: {why}"
    evidence = Evidence(Quantity.POSITION, here, end, unit, joint, time=hold.until)
    return Violation("let go on the way", reason, evidence, abs(end - here))


def let_go(holds: Sequence[Hold]) -> Iterator[str]:
    """What a certificate rests on if the hand leaves the handle before the motion ends."""
    for k, hold in enumerate(holds):
        name, when = hold.container.name, f"from {hold.time:.2f} s to {hold.until:.2f} s"
        if hold.onward is not None:
            other = holds[k + 1].gripper.name if k + 1 < len(holds) else hold.gripper.name
            by = "" if other == hold.gripper.name else f", by gripper {other} after {hold.gripper.name}"
            yield f"let go on the way: {name} is held {when}, then anew{by}; nothing in D_artic moves it"
        elif hold.left < len(hold.pieces.start):
            yield f"let go: {name} is held {when}, and nothing in D_artic moves it afterwards"
