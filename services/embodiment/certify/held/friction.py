r"""How much friction a certified motion takes between fingers and handle.

Fingers press along the way in which they close. By a face that looks :math:`\alpha` away from it they hold,
however hard they press, if the coefficient of friction is :math:`\tan \alpha` or more; with less they may
slide off. What pulls across them, a drawer's weight or a door's spring, takes more: D_artic knows no forces.
"""

import math
from collections.abc import Mapping, Sequence

from services.embodiment.certify.findings import Findings
from services.embodiment.certify.held.hold import Hold

FRICTION = "friction needed"
"""Name of the figure that says so."""

UNKNOWN = "friction needed: not known, since nothing shows how the faces look that touch the handle"


def friction(holds: Sequence[Hold], turn: float) -> Findings:
    """A coefficient of friction [1] with which fingers that press do not slide off, or that none is known.

    No less than is needed, as faces are told by how shapes meet within 1 mm.

    Args:
        holds: Of a certified motion.
        turn: How far the tool turns on the handle meanwhile, at most [rad].
    """
    slant = max(hold.slant for hold in holds) + turn
    if slant >= math.pi / 2:
        return Findings(nearest=[UNKNOWN])
    return Findings(figures={FRICTION: (math.tan(slant), "1")})


def slanted(figures: Mapping[str, tuple[float, str]]) -> float:
    """How far the faces look away [rad] by these figures of a certificate; pi / 2 where they do not tell."""
    return math.atan(figures[FRICTION][0]) if FRICTION in figures else math.pi / 2
