"""A container's force model, read from the twin: every parameter as an interval, none guessed."""

from dataclasses import replace

from sdt_kg.entities.moving_together import HANGS_ON, moving_together
from sdt_kg.errors import OracleRejectedError
from sdt_kg.iri import Iri, local_name
from sdt_kg.mechanism import Mechanism
from sdt_kg.twin import Container, Twin
from services.dynamics.load import load_of
from services.dynamics.model import ForceModel, Mechanics, Other, Values
from services.physics.tree import Model

_SAME_NAME = {
    "coulomb": "coulombFriction",
    "break_away": "breakAwayFriction",
    "viscous": "viscousFriction",
    "stiffness": "springStiffness",
    "latch": "latchForce",
    "closer": "softCloserForce",
    "closer_damping": "softCloserDamping",
}


def force_model(twin: Twin, joint: Iri) -> ForceModel:
    """What the twin says pushes back at a joint.

    Raises:
        OracleRejectedError: A parameter is missing; the shapes of D_artic_dyn tell all that are.
    """
    facts = twin.entities.facts
    models = facts.iris(joint, "hasForceModel")
    if len(models) != 1:
        raise OracleRejectedError(f"{local_name(joint)} has {len(models)} force models, not one")
    iri = models[0]

    def number(name: str) -> float:
        try:
            return facts.number(iri, name)
        except KeyError:
            raise OracleRejectedError(f"force model {local_name(iri)} has no sdt:{name}") from None

    def values(end: str, spread: float) -> Values:
        return Values(
            mass=number(f"movedMass{end}") + number(f"contentsMass{end}"),
            inertia=1.0 + spread,
            weight=1.0 + spread,
            **{field: number(f"{name}{end}") for field, name in _SAME_NAME.items()},
        )

    slides = not any(local_name(each) == "HingeForceModel" for each in facts.types(iri))
    spread = 0.0 if slides else number("massSpread")
    return ForceModel(
        values("From", -spread),
        values("To", spread),
        number("springRestPosition"),
        number("latchWidth"),
        number("softCloserRange"),
        number("allowedHandleForce"),
        iri,
    )


def mechanics_of(model: Model, twin: Twin, container: Container) -> Mechanics:
    """All that forces at the container's handle depend on.

    Args:
        model: Built from the twin's environment.
        twin: The kitchen in its state.
        container: One of whose joints that move together none carries another.

    Raises:
        OracleRejectedError: A parameter or a shape is missing, or a joint carries another that moves with it.
    """
    kitchen = twin.mechanism(twin.environment)
    if folds(kitchen, container.joint):
        raise OracleRejectedError(f"{container.name} folds: one of its joints hangs on another")
    others = tuple(
        _other(model, twin, container, joint, *how)
        for joint, how in sorted(twin.entities.coupling.together(container.joint).items())
    )
    load, forces = load_of(model, twin, container.joint, container), force_model(twin, container.joint)
    return Mechanics(container.joint, forces, load, container.lower, container.upper, others)


def _other(  # noqa: PLR0913, PLR0917 - a joint, and how it moves with the container's
    model: Model, twin: Twin, container: Container, joint: Iri, ratio: float, offset: float
) -> Other:
    """A joint that moves with a container's own, counted from closed to open, wherever its axis points."""
    load = load_of(model, twin, joint)
    if ratio < 0:
        load = replace(load, cosine=-load.cosine, constant=-load.constant)
        ratio, offset = -ratio, -offset
    lower, upper = (ratio * end + offset for end in (container.lower, container.upper))
    return Other(ratio, offset, Mechanics(joint, force_model(twin, joint), load, lower, upper))


def folds(kitchen: Mechanism, joint: Iri) -> bool:
    """Whether one of the joints that move together hangs on another."""
    return any(name == HANGS_ON for _, name, _ in moving_together(kitchen, joint))
