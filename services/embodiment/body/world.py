"""The scene as the planner sees it: fast, with margins, sound where it says free."""

from collections.abc import Iterable
from dataclasses import dataclass, field

import coal  # pyright: ignore[reportMissingImports]  # found through a .pth file
import numpy as np
from numpy.typing import NDArray

from sdt_kg.iri import Iri
from sdt_kg.mechanism import JointType
from services.embodiment.body import contacts, kernels, postures
from services.physics.geometry.convex import BALL, MESH
from services.physics.geometry.gap import gap
from services.physics.model import Scene

Array = NDArray[np.float64]
Pair = tuple[int, int]

MAY_TOUCH = -1.0  # as a margin: the pair is not looked at
STRIDES = (64, 8, 1)  # every how many configurations are looked at, of many first these


@dataclass(frozen=True, slots=True, eq=False)
class Rules:
    """Distances demanded of pairs [m].

    Attributes:
        environment: Shape (robot shapes, kitchen shapes); MAY_TOUCH where contact is allowed.
        pairs: Self pairs that are looked at, shape (P, 2).
        own: Their distances, shape (P,).
        largest: Of the distances in `environment`.
    """

    environment: Array
    pairs: NDArray[np.int64]
    own: Array
    largest: float = field(init=False)

    def __post_init__(self) -> None:
        object.__setattr__(self, "largest", float(self.environment.max(initial=0.0)))


@dataclass(frozen=True, slots=True)
class Contact:
    """Two shapes nearer than their margin.

    Attributes:
        index: Which configuration of those asked about.
    """

    index: int
    shapes: Pair


class World:
    """Collision checks of many configurations of one scene.

    Attributes:
        split: Index of the robot's first shape; those before are the kitchen's.
        tree, boxes, shapes: What `contacts.contacts` takes.
        half: Half extents of each shape's own box [m], shape (S, 3).
    """

    def __init__(self, scene: Scene) -> None:
        self.scene = scene
        self.tree = _tree(scene)
        solids = scene.solids
        self.split = next((i for i, one in enumerate(solids) if scene.is_robot(one)), len(solids))
        self.shapes = scene.outlines.convex
        kind = self.shapes[0][: len(solids)]
        assert not (kind[self.split :] == MESH).any(), "a robot's meshes are convex pieces"
        self.half = np.array([one.half for one in solids]).reshape(-1, 3)
        self.radius = np.where(kind == BALL, self.half[:, 0], [one.radius for one in solids])
        self.boxes = (
            np.array([one.joint for one in solids], dtype=np.int64),
            np.array([one.joint_T_shape.rotation for one in solids]).reshape(-1, 3, 3),
            np.array([one.centre for one in solids]).reshape(-1, 3),
        )
        self.joint_T_shape = [one.joint_T_shape for one in solids]
        self.body = [one.body for one in solids]
        self._shapes: dict[Iri, list[int]] = {}
        for i, body in enumerate(self.body):
            self._shapes.setdefault(body, []).append(i)
        self._base = int(scene.base[2]) + 1

    def shapes_of(self, bodies: Iterable[Iri]) -> NDArray[np.int64]:
        """Indices of the shapes of these bodies."""
        found = (i for body in set(bodies) for i in self._shapes.get(body, ()))
        return np.array(sorted(found), dtype=np.int64)

    def above(self) -> NDArray[np.bool_]:
        """Whether joint k carries joint j, or is it: element (j, k), shape (J, J)."""
        parents = self.tree[0]
        found = np.eye(len(parents), dtype=np.bool_)
        for j, parent in enumerate(parents[1:], 1):
            found[j] |= found[parent]
        return found

    def carried(self, joints: NDArray[np.intp]) -> NDArray[np.bool_]:
        """Whether shape s is carried by one of some joints: element (s, k) for the k-th, shape (S, K)."""
        return np.ascontiguousarray(self.above()[self.boxes[0]][:, joints])

    def frames(self, q: Array) -> tuple[Array, Array]:
        """World poses of all joint frames: rotations (J, 3, 3) and translations (J, 3)."""
        r, p = np.empty((len(self.tree[0]), 3, 3)), np.empty((len(self.tree[0]), 3))
        kernels.forward(np.ascontiguousarray(q), self.tree, r, p)
        return r, p

    def poses(self, configurations: Array, joint: int) -> tuple[Array, Array]:
        """World poses of one joint frame at each configuration (N, nq): shapes (N, 3, 3) and (N, 3)."""
        r, p = np.empty((len(configurations), 3, 3)), np.empty((len(configurations), 3))
        kernels.poses(np.ascontiguousarray(configurations), self.tree, joint, r, p)
        return r, p

    def contact(self, configurations: Array, rules: Rules) -> Contact | None:
        """A pair nearer than its margin in one of the configurations, shape (N, nq); None if all are free.

        Not always that of the first such configuration: a few are looked at before the others.
        """
        qs = np.ascontiguousarray(configurations)  # one memory layout, one compilation
        at, one, other = contacts.contacts(qs, STRIDES, *self._scene(rules))
        return Contact(at, (one, other)) if at >= 0 else None

    def _scene(self, rules: Rules) -> tuple:
        """What compiled loops take, but for configurations."""
        scene = self.tree, self.boxes, self.split, self.radius, self.shapes, self._base
        return (*scene, (rules.pairs, rules.own), rules.environment, rules.largest)

    def contact_each(self, configurations: Array, rules: Rules) -> list[Pair | None]:
        """The shapes of a contact at each of some configurations (N, nq), None where it is free."""
        found = np.empty((len(configurations), 2), np.int64)
        postures.contacts_each(found, np.ascontiguousarray(configurations), *self._scene(rules))
        return [(a, b) if a >= 0 else None for a, b in found.tolist()]

    def free(self, q: Array, rules: Rules) -> bool:
        """Whether all pairs keep their margins at one configuration, shape (nq,)."""
        return self.contact(q[None], rules) is None

    def distance(self, pair: Pair, r: Array, p: Array) -> float:
        """Signed distance of two shapes [m], negative when they penetrate."""
        (one, one_at), (other, other_at) = (
            (self.scene.solids[k].shape, self._transform(k, r, p)) for k in pair
        )
        return gap(one, one_at, other, other_at)[0]

    def distances(self, pairs: NDArray[np.int64], r: Array, p: Array) -> Array:
        """Signed distances of pairs of shapes (M, 2) [m], negative when they penetrate, shape (M,)."""
        low, high = np.empty(len(pairs)), np.empty(len(pairs))
        contacts.distances(self.shapes, self.boxes, pairs, r, p, low, high)
        for k in np.flatnonzero(low == -np.inf):
            low[k] = self.distance((int(pairs[k, 0]), int(pairs[k, 1])), r, p)
        return low

    def _transform(self, k: int, r: Array, p: Array) -> coal.Transform3s:
        j, local = self.boxes[0][k], self.joint_T_shape[k]
        return coal.Transform3s(r[j] @ local.rotation, r[j] @ local.translation + p[j])


def _tree(scene: Scene) -> tuple[NDArray[np.int64], Array, Array, Array, NDArray[np.int64]]:
    """(parent, placement rotations, placement translations, axes, kinds) of joints 0 … nq."""
    model = scene.model
    count = model.nq + 1
    axes, kinds = np.zeros((count, 3)), np.zeros(count, np.int64)
    axes[scene.base + 1] = np.eye(3)[[0, 1, 2]]
    kinds[scene.base[2] + 1] = kernels.REVOLUTE
    for part in (scene.kitchen, scene.robot):
        for k, joint in enumerate(part.joints, part.first + 1):
            axes[k] = joint.axis
            kinds[k] = 0 if joint.type is JointType.PRISMATIC else kernels.REVOLUTE
    placements = list(model.jointPlacements)
    return (
        np.array(list(model.parents), dtype=np.int64),
        np.array([one.rotation for one in placements]),
        np.array([one.translation for one in placements]),
        axes,
        kinds,
    )
