"""A container's force model, read from the twin: every parameter as an interval, none guessed."""

from dataclasses import replace

from sdt_kg.entities.moving_together import FOLDS_ON, HANGS_ON, moving_together
from sdt_kg.errors import OracleRejectedError
from sdt_kg.iri import Iri, local_name
from sdt_kg.mechanism import Mechanism
from sdt_kg.twin import Container, Twin
from services.dynamics.fold import Moves, chain_of, fold_of, reach_of
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
        container: Whose joints that move together carry one another only as panels of a folding door.

    Raises:
        OracleRejectedError: A parameter or a shape is missing, or a joint carries another in another way.
    """
    if unfit(twin.mechanism(twin.environment), container.joint):
        what = (
            f"one joint of {container.name} carries another that moves with it, but not as a folding door's"
        )
        raise OracleRejectedError(what)
    moves = {container.joint: (1.0, 0.0), **twin.entities.coupling.together(container.joint)}
    others = tuple(
        _other(model, twin, container, joint, moves) for joint in sorted(moves) if joint != container.joint
    )
    chain = chain_of(model, twin, container.joint, moves)
    return Mechanics(
        container.joint,
        force_model(twin, container.joint),
        load_of(model, twin, container.joint, container, moves),
        container.lower,
        container.upper,
        others,
        None if chain is None else fold_of(model, twin, chain, moves),
        None if chain is None else reach_of(model, twin, chain, container, moves),
    )


def _other(model: Model, twin: Twin, container: Container, joint: Iri, moves: Moves) -> Other:
    """A joint that moves with a container's own, counted from closed to open, wherever its axis points."""
    load, (ratio, offset) = load_of(model, twin, joint, apart=moves), moves[joint]
    forces, chain = force_model(twin, joint), chain_of(model, twin, joint, moves)
    if ratio < 0:
        load = replace(load, cosine=-load.cosine, constant=-load.constant)
        forces = replace(forces, rest=-forces.rest)
        ratio, offset = -ratio, -offset
    lower, upper = (ratio * end + offset for end in (container.lower, container.upper))
    fold = None if chain is None else fold_of(model, twin, chain, moves)
    own = Mechanics(joint, forces, load, lower, upper, fold=fold)
    return Other(ratio, offset, own)


def unfit(kitchen: Mechanism, joint: Iri) -> bool:
    """Whether of the joints that move together one carries another otherwise than in a folding door."""
    told = set(moving_together(kitchen, joint))
    return any(name == HANGS_ON and (one, FOLDS_ON, other) not in told for one, name, other in told)
