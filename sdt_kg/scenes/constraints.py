"""What an MJCF scene says of joints and bodies besides: that one joint follows another; no more is read."""

from collections.abc import Collection
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from sdt_kg.errors import UrdfError
from sdt_kg.mechanism import Mimic

# MuJoCo's stubs name no attribute of a compiled model: what it gives enters here.
Model = Any

FREE, BALL, SLIDE, HINGE = range(4)
CONNECT, WELD, JOINT = range(3)
"""mjtEq of what holds two bodies, or couples two joints."""


def name_of(library: Model, model: Model, kind: str, index: int) -> str:
    """Name of a body, joint or geom; one without name is numbered."""
    of = getattr(library.mjtObj, f"mjOBJ_{kind.upper()}")
    return library.mj_id2name(model, of, index) or f"{kind}_{index}"


def reference_of(model: Model, joint: int) -> float:
    """Position of a hinge or slide in which the file shows it [rad or m]."""
    return float(model.qpos0[model.jnt_qposadr[joint]])


@dataclass(frozen=True, slots=True)
class Constraints:
    """Those of one compiled model."""

    library: Model
    model: Model
    path: Path

    def couplings(self, carried: Collection[str]) -> tuple[dict[str, Mimic], list[str]]:
        """Joint name → what it follows; and the equality constraints that hold nothing that moves here.

        Args:
            carried: Names of the joints that are read.

        Raises:
            UrdfError: Something would move otherwise than its joints say.
        """
        model, found, other = self.model, dict[str, Mimic](), list[str]()
        for tendon in range(model.ntendon):
            if model.tendon_limited[tendon]:
                raise self._held("limited tendon", self._name("tendon", tendon))
        for index in range(model.neq):
            name = self._name("equality", index)
            if not model.eq_active0[index] or not self._may_move(index):
                other.append(name)
                continue
            one, two = int(model.eq_obj1id[index]), int(model.eq_obj2id[index])
            a, b, *higher = model.eq_data[index][:5].tolist()
            if model.eq_type[index] != JOINT or two < 0 or any(higher):
                raise self._held("equality constraint", name)
            follower, leader = self._name("joint", one), self._name("joint", two)
            if not {follower, leader} <= {*carried} or follower in found:
                raise self._held("equality constraint", name)
            found[follower] = Mimic(leader, b, a + reference_of(model, one) - b * reference_of(model, two))
        return found, other

    def _name(self, kind: str, index: int) -> str:
        return name_of(self.library, self.model, kind, index)

    def _held(self, what: str, name: str) -> UrdfError:
        return UrdfError(
            f"{self.path}: {what} '{name}' holds or couples what its joints alone would let move",
            allowed="one joint that follows one other in a straight line (a and b of polycoef)",
            remedy="write it as that, or with limits of the joints; or take it out, or make it inactive",
        )

    def _may_move(self, equality: int) -> bool:
        """Whether an end of an equality constraint moves by a hinge or slide, as far as is known."""
        model, kind = self.model, int(self.model.eq_type[equality])
        ends = [int(each[equality]) for each in (model.eq_obj1id, model.eq_obj2id) if each[equality] >= 0]
        if kind == JOINT:
            return any(model.jnt_type[joint] in (SLIDE, HINGE) for joint in ends)
        if kind not in (CONNECT, WELD):
            return True
        if model.eq_objtype[equality] == int(self.library.mjtObj.mjOBJ_SITE):
            ends = [int(model.site_bodyid[site]) for site in ends]
        return any(map(self._is_carried, ends))

    def _is_carried(self, body: int) -> bool:
        """Whether a hinge or slide moves the body."""
        model = self.model
        while body:
            first, count = int(model.body_jntadr[body]), int(model.body_jntnum[body])
            if any(model.jnt_type[joint] in (SLIDE, HINGE) for joint in range(first, first + count)):
                return True
            body = int(model.body_parentid[body])
        return False
