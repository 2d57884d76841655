"""The oracles of this process, as the class D that is asked about has them."""

from predicates.oracle import Embodiment, Physics
from services.app import Forces, whole_body
from services.policy import Policy
from services.relative import TeeName


def own_physics(tee: TeeName) -> Physics:
    """Φ."""
    if tee == "d_artic_dyn":
        return Forces().physics()
    from services.physics.oracle import Kinematics  # noqa: PLC0415 - only where physics is asked for

    return Kinematics()


def own_embodiment(tee: TeeName, policy: Policy) -> Embodiment:
    """R under a policy."""
    return Forces().embodiment(policy) if tee == "d_artic_dyn" else whole_body(policy)
