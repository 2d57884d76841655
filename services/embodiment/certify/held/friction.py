r"""How much friction a certified motion takes between fingers and handle.

Fingers press along the way in which they close. By a face that looks :math:`\alpha` away from it they hold,
however hard they press, if the coefficient of friction is :math:`\tan \alpha` or more; with less they may
slide off. What pulls across them, a drawer's weight or a door's spring, takes more: D_artic knows no forces.
"""

import math
from collections.abc import Mapping, Sequence

from predicates.case import Evidence, Quantity
from sdt_kg.iri import local_name
from services.embodiment.certify.findings import Findings, Violation
from services.embodiment.certify.held.hold import Hold

FRICTION = "friction needed"
"""Name of the figure that says so."""

UNKNOWN = "friction needed: not known, since nothing shows how the faces look that touch the handle"


def friction(holds: Sequence[Hold], turn: float, cone: float) -> Findings:
    """A coefficient of friction [1] with which fingers that press do not slide off, or that none is known.

    No less than is needed, as faces are told by how shapes meet within 1 mm.

    Args:
        holds: Of a certified motion.
        turn: How far the tool turns on the handle meanwhile, at most [rad].
        cone: How far faces may look away from the way in which fingers close [rad].
    """
    worst = max(holds, key=lambda hold: hold.slant)
    slant = min(worst.slant + turn, math.pi / 2)
    known = slant < math.pi / 2
    violations = [_slides_off(worst, slant, cone)] if slant > cone else []
    figures = {FRICTION: (math.tan(slant), "1")} if known else {}
    return Findings(violations, figures, nearest=[] if known else [UNKNOWN])


def _slides_off(hold: Hold, slant: float, cone: float) -> Violation:
    handle, asked = local_name(hold.container.handle), math.tan(cone)
    takes = f"takes friction of {math.tan(slant):.3g}" if slant < math.pi / 2 else "may take any friction"
    reason = (
        f"{hold.gripper.name} holds {handle} by faces that look {math.degrees(slant):.3g}° away from the way "
        f"in which fingers close, which {takes}, and {asked:.3g} is asked"
    )
    evidence = Evidence(Quantity.ORIENTATION_ERROR, slant, cone, "rad", hold.container.handle, time=hold.time)
    return Violation("friction", reason, evidence, slant - cone)


def slanted(figures: Mapping[str, tuple[float, str]]) -> float:
    """How far the faces look away [rad] by these figures of a certificate; pi / 2 where they do not tell."""
    return math.atan(figures[FRICTION][0]) if FRICTION in figures else math.pi / 2
