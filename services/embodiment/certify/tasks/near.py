"""Distance of the robot to a body of the kitchen along a step, between samples too."""

from dataclasses import dataclass

import numpy as np

from predicates.specification.leg import Leg
from predicates.specification.rules import Approach
from sdt_kg.iri import Iri
from services.embodiment.certify.motion import whole_motion
from services.embodiment.certify.sweep.clearance import Pairs, Sweep
from services.embodiment.certify.sweep.subject import subject
from services.embodiment.certify.tolerances import Tolerances
from services.physics.model import Scene


@dataclass(frozen=True, slots=True)
class Swept:
    """Clearance by the certifier's sweep and shapes."""

    robot: Iri

    def keeps(self, leg: Leg, body: Iri, distance: float) -> Approach:
        """Whether the robot, in its shapes that contain it, keeps the distance, between samples too."""
        scene, tolerances = Scene(leg.twin, self.robot), Tolerances()
        pieces, _ = whole_motion(scene, leg.motion, tolerances)
        about = subject(scene, pieces, tolerances)
        solids = [k for k, one in enumerate(scene.solids) if one.body == body]
        if not solids:
            return Approach(keeps=None)
        # Wheels, too, which may stand on it: nothing is told as far away that touches.
        robot = [i for i, one in enumerate(scene.solids) if scene.is_robot(one)]
        pairs = np.array([(i, k) for i in robot for k in solids], dtype=np.intp)
        least = np.full(len(pairs), distance + scene.annotation.overhang)
        sets = [Pairs(pairs, least, least, np.inf)]
        (found,) = Sweep(about.timeline, about.kinematics, about.shapes, sets).run(tolerances.resolution)
        if found.first is not None:
            # What is not resolved at first may be seen to be broken later: a break is a break.
            seen, worst = found.first, found.worst
            if not seen.resolved and worst is not None and worst.value < worst.least:
                seen = worst
            keeps = False if seen.resolved else None
            return Approach(keeps, seen.value, seen.time, scene.solids[seen.pair[0]].body)
        return Approach(keeps=None, time=found.gave_up) if found.gave_up is not None else Approach(keeps=True)
