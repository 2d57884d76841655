"""Containers that a motion leaves alone: a verdict rests on their staying where the state has them."""

from collections.abc import Iterator
from dataclasses import dataclass

from predicates.case import Diagnosis, Evidence, Quantity
from predicates.oracle import RESTLESS, UNCHECKED
from sdt_kg.errors import OracleRejectedError
from sdt_kg.iri import Iri, local_name
from sdt_kg.twin import Container, Twin
from services.dynamics.judge import inside, left_open, pull, way
from services.dynamics.model import Mechanics
from services.dynamics.parameters import mechanics_of
from services.dynamics.rest import at_rest
from services.physics.tree import UNIVERSE, Model


@dataclass(frozen=True, slots=True)
class Unheld:
    """What is found of them.

    Attributes:
        diagnoses: Abstentions about those that hang on what moves, or rest for no value.
        notes: About others in doubt.
        figures: How many of these may move, if any may; and each of which that was not checked.
    """

    diagnoses: tuple[Diagnosis, ...]
    notes: tuple[str, ...]
    figures: dict[str, tuple[float, str]]


def unheld(model: Model, twin: Twin, container: Container, mechanics: Mechanics) -> Unheld:
    """What is to be said of all containers but one, and those that move with it.

    Args:
        model: Built from the twin's environment.
        twin: The kitchen in the state in which the motion begins.
        container: What the motion moves.
        mechanics: Of that container.
    """
    diagnoses, doubtful, unknown = list[Diagnosis](), list[str](), list[str]()
    carried = _carried(model, mechanics)
    for each in _alone(twin, container):
        if carried & {each.joint, *twin.entities.coupling.together(each.joint)}:
            what = f"{each.name} hangs on {container.name}, and what drives it as that moves is not modelled"
            evidence = Evidence(Quantity.COUNT, 1.0, 0.0, "1", entity=each.joint)
            diagnoses.append(left_open(mechanics, what, evidence))
            continue
        try:
            its = mechanics_of(model, twin, each)
        except OracleRejectedError:
            unknown.append(each.name)
            continue
        rest = at_rest(its, inside(its, twin.state[each.joint]))
        if rest.surely:
            what = f"{each.name}, which nobody holds, does not stay where it begins: it moves {way(rest)}"
            diagnoses.append(left_open(its, what, pull(its, rest)))
        elif not rest.stays:
            doubtful.append(each.name)
    figures = {RESTLESS: (float(len(doubtful)), "1")} if doubtful else {}
    figures |= {UNCHECKED + name: (1.0, "1") for name in unknown}
    notes = (*_notes(doubtful, unknown), *_stiff(model, twin, container, mechanics))
    return Unheld(tuple(diagnoses), notes, figures)


def _alone(twin: Twin, container: Container) -> Iterator[Container]:
    """One container of all that move together, but for those that move with this one."""
    seen = {container.joint, *twin.entities.coupling.together(container.joint)}
    for each in twin.containers():
        if each.joint not in seen:
            seen |= {each.joint, *twin.entities.coupling.together(each.joint)}
            yield each


def _carried(model: Model, mechanics: Mechanics) -> set[Iri]:
    """Joints that hang on those that move."""
    own = [each.mechanics.joint for each in mechanics.moving]
    below = {k for joint in own for k in model.model.subtrees[model.model.getJointId(joint)]}
    return {model.model.names[k] for k in below} - {*own}


def _stiff(model: Model, twin: Twin, container: Container, mechanics: Mechanics) -> Iterator[str]:
    """Joints taken to be still: those that hang on the container and are none, those that it hangs on."""
    counted = {each.joint for each in twin.containers()}
    own = {each.mechanics.joint for each in mechanics.moving}
    hanging = sorted(map(local_name, _carried(model, mechanics) - counted))
    if hanging:
        yield (
            f"taken to be rigid with {container.name}, though no force model says what drives them as it "
            f"moves: {', '.join(hanging)}"
        )
    above = {k for joint in own for k in model.model.supports[model.model.getJointId(joint)]} - {UNIVERSE}
    carrying = sorted(local_name(each) for each in {model.model.names[k] for k in above} - own)
    if carrying:
        yield (
            f"taken not to move under the force on {container.name}, which hangs on them: "
            f"{', '.join(carrying)}"
        )


def _notes(doubtful: list[str], unknown: list[str]) -> Iterator[str]:
    if doubtful:
        yield f"taken to stay where the state has it, though it may move: {', '.join(doubtful)}"
    if unknown:
        yield f"not checked, for want of a force model: whether {', '.join(unknown)} stays where it is"
