"""What an MJCF scene says of joints besides: that one follows another, or is held; no more is read."""

from collections.abc import Collection, Iterator, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from sdt_kg.errors import UrdfError
from sdt_kg.mechanism import Mimic
from sdt_kg.scenes.build import Link

# MuJoCo's stubs name no attribute of a compiled model: what it gives enters here.
Model = Any

FREE, BALL, SLIDE, HINGE = range(4)
CONNECT, WELD, JOINT, TENDON = range(4)
"""mjtEq of what holds two bodies, or couples two joints or tendons."""

WRAP_JOINT, WRAP_PULLEY, WRAP_SITE = 1, 2, 3
"""mjtWrap of what a tendon is made of; all others are geoms."""


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

    def applied(self, links: Sequence[Link]) -> tuple[list[Link], list[str]]:
        """The joints as they move by them; and the equality constraints that hold nothing that moves here.

        Raises:
            UrdfError: Something would move otherwise than its joints say.
        """
        model, found, other = self.model, {link.name: link for link in links}, list[str]()
        for tendon in range(model.ntendon):
            if model.tendon_limited[tendon] and self._is_pulled(tendon):
                raise self._held("limited tendon", self._name("tendon", tendon))
        tied = set[str]()
        for index in range(model.neq):
            name, joint = self._name("equality", index), self._name("joint", int(model.eq_obj1id[index]))
            if not model.eq_active0[index] or not self._may_move(index):
                other.append(name)
                continue
            if model.eq_type[index] != JOINT or joint not in found or joint in tied:
                raise self._held("equality constraint", name)
            tied.add(joint)
            found[joint] = self._tied(index, found[joint], found)
        return list(found.values()), other

    def _tied(self, equality: int, link: Link, known: Collection[str]) -> Link:
        """The first joint of an equality constraint: it is held, or follows the second."""
        model, name = self.model, self._name("equality", equality)
        one, two = int(model.eq_obj1id[equality]), int(model.eq_obj2id[equality])
        a, b, *higher = model.eq_data[equality][:5].tolist()
        at = a + reference_of(model, one)
        if two < 0 and link.limits.lower <= at <= link.limits.upper:
            notes = (*link.notes, f"held by equality constraint '{name}'")
            return replace(link, limits=replace(link.limits, lower=at, upper=at), notes=notes)
        if two < 0 or any(higher) or (leader := self._name("joint", two)) not in known:
            raise self._held("equality constraint", name)
        return replace(link, mimic=Mimic(leader, b, at - b * reference_of(model, two)))

    def _name(self, kind: str, index: int) -> str:
        return name_of(self.library, self.model, kind, index)

    def _held(self, what: str, name: str) -> UrdfError:
        return UrdfError(
            f"{self.path}: {what} '{name}' holds or couples what its joints alone would let move",
            allowed="one joint that is held within its range, or follows one other in a straight line "
            "(a and b of polycoef)",
            remedy="write it as that, or with limits of the joints; or take it out, or make it inactive",
        )

    def _may_move(self, equality: int) -> bool:
        """Whether an end of an equality constraint moves by a hinge or slide, as far as is known."""
        model, kind = self.model, int(self.model.eq_type[equality])
        ends = [int(each[equality]) for each in (model.eq_obj1id, model.eq_obj2id) if each[equality] >= 0]
        if kind == JOINT:
            return any(model.jnt_type[joint] in (SLIDE, HINGE) for joint in ends)
        if kind == TENDON:
            return any(map(self._is_pulled, ends))
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

    def _is_pulled(self, tendon: int) -> bool:
        """Whether the tendon joins something that a hinge or slide moves."""
        model, first = self.model, int(self.model.tendon_adr[tendon])
        on = range(first, first + int(model.tendon_num[tendon]))
        if any(model.wrap_type[each] == WRAP_JOINT for each in on):
            return True
        return any(map(self._is_carried, self._bodies_along(on)))

    def _bodies_along(self, wraps: range) -> Iterator[int]:
        """Bodies along which a tendon passes."""
        for each in wraps:
            kind, at = int(self.model.wrap_type[each]), int(self.model.wrap_objid[each])
            if kind != WRAP_PULLEY:
                yield int((self.model.site_bodyid if kind == WRAP_SITE else self.model.geom_bodyid)[at])
