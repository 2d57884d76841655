"""A container's force model, read from the twin: every parameter as an interval, none guessed."""

from sdt_kg.errors import InputError, OracleRejectedError
from sdt_kg.iri import Iri, local_name
from sdt_kg.twin import Container, Twin
from services.dynamics.load import load_of
from services.dynamics.model import ForceModel, Mechanics, Values
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
        container: One whose joint nothing follows and that follows nothing.

    Raises:
        OracleRejectedError: A parameter or a shape is missing.
        InputError: Other joints move with this one.
    """
    if others := followers(model, container):
        names = ", ".join(map(local_name, others))
        raise InputError(f"{names} moves with {container.name}", allowed="forces of one joint alone")
    forces = force_model(twin, container.joint)
    return Mechanics(
        container.joint, forces, load_of(model, twin, container), container.lower, container.upper
    )


def followers(model: Model, container: Container) -> list[Iri]:
    """Joints that move with the container's own."""
    source = model.coupling.source
    k = model.coordinate[container.joint]
    return [
        joint
        for joint, other in model.coordinate.items()
        if other != k and source[other] == source[k] and model.coupling.multiplier[other] != 0
    ]
