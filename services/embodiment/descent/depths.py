"""What a limb's shapes lack of the distances demanded of them, as a residual that a descent drives out."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from services.embodiment.body.demands import Margins, rules, touching
from services.embodiment.body.limb import Limb
from services.embodiment.body.world import MAY_TOUCH, Contact, Rules, World
from services.embodiment.descent import witness
from services.embodiment.descent.pressed import pressed
from services.embodiment.hold.grasp import Hand
from services.embodiment.hold.handle import Mechanics

Array = NDArray[np.float64]

BUFFER = 0.0005  # [m] beyond what certification demands
SPARE = 0.2 * BUFFER  # [m] of that
ROWS = 256  # pairs that count at once
NOTHING = Margins(0.0, 0.0, 0.0)  # beyond what certification demands


@dataclass(frozen=True, slots=True, eq=False)
class Depths:
    """Pairs of one limb's shapes, its base standing, and a hand that holds one handle.

    Attributes:
        scene, pairs, levers: What `pressed` takes.
        room: The same: what it writes to.
    """

    world: World
    limb: Limb
    hand: Hand
    mechanics: Mechanics
    pairs: tuple
    scene: tuple
    levers: tuple
    room: tuple[tuple[NDArray[np.int64], Array], Array, tuple]

    def q(self, x: Array, shares: Array, value: float) -> Array:
        """The scene's configuration at x (n,), fingers closed by shares (F,), the container at a value."""
        return self.mechanics.put_each(self.limb.q(x, self.hand.closed(shares))[None], np.array([value]))[0]

    def residual(self, x: Array, shares: Array, value: float) -> tuple[Array, Array]:
        """What pairs lack (N,) [m], and how that changes with each variable, shape (N, n)."""
        (_, lacks), rows, _ = self.room
        q = self.q(x, shares, value)
        count = pressed(q, *self.scene, self.pairs, self.levers, *self.room)
        return lacks[:count].copy(), rows[:count].copy()


def make_depths(world: World, limb: Limb, hand: Hand, mechanics: Mechanics, start: Array) -> Depths:
    """Depths of a limb whose base stands at `start` (3,), of pairs that arm or fingers part.

    Of its own pairs that are nearer than that where it is parked, half of what is there is demanded.
    """
    demands = touching(world, limb, rules(world, limb, NOTHING), (mechanics.container.handle,))
    there = world.distances(demands.pairs, *world.frames(world.scene.q(tuple(start.tolist()), {})))
    own = demands.own + np.clip((there - demands.own) / 2, 0.0, BUFFER)
    levers = _levers(world, limb)
    moves = _moves(world, limb, levers)
    robot, kitchen = np.nonzero((demands.environment >= 0) & moves[:, None])
    outside = demands.environment[robot, kitchen] + BUFFER
    shapes = np.concatenate([demands.pairs, np.column_stack((robot + world.split, kitchen))])
    pairs = _grouped(world, shapes, np.concatenate([own, outside]))
    found = np.empty(ROWS, np.int64), np.empty(ROWS)
    frames = np.empty((len(world.tree[0]), 3, 3)), np.empty((len(world.tree[0]), 3))
    boxes = np.empty((len(world.body), 3, 3)), np.empty((len(world.body), 3))
    room = found, np.empty((ROWS, len(limb.lower))), (frames, boxes, np.zeros(12), witness.room())
    scene = world.tree, world.boxes, world.radius, world.half, world.shapes
    return Depths(world, limb, hand, mechanics, pairs, scene, levers, room)


def _grouped(world: World, shapes: NDArray[np.int64], demands: Array) -> tuple:
    """Pairs of shapes (P, 2) and the distances demanded (P,), in groups that a ball each can part."""
    joints, _, middles = world.boxes
    alone = np.arange(len(joints)) < world.split  # what is not the robot's
    _, ball = np.unique(
        np.where(alone, joints.max() + 1 + np.arange(len(joints)), joints), return_inverse=True
    )
    order = np.lexsort(ball[shapes].T)
    shapes, demands = np.ascontiguousarray(shapes[order], np.int64), demands[order]
    changes = np.any(np.diff(ball[shapes], axis=0, prepend=-1), axis=1)
    first = np.flatnonzero(changes)
    last = np.append(first[1:], len(shapes))
    groups = np.column_stack((ball[shapes[first]], first, last)).astype(np.int64)
    widest = np.maximum.reduceat(demands, first) if len(first) else demands
    members = [np.flatnonzero(ball == one) for one in range(int(ball.max()) + 1)]
    balls = np.array([_ball(middles[some], world.radius[some]) for some in members])
    carriers = np.array([joints[some[0]] for some in members], np.int64)
    return shapes, demands, groups, widest, (carriers, balls[:, :3].copy(), balls[:, 3].copy())


def _ball(middles: Array, radius: Array) -> Array:
    """Middle and radius of a ball about balls, shape (4,)."""
    low, high = (middles - radius[:, None]).min(axis=0), (middles + radius[:, None]).max(axis=0)
    middle = (low + high) / 2
    return np.append(middle, (np.linalg.norm(middles - middle, axis=1) + radius).max())


def unmoved(limb: Limb, mechanics: Mechanics, start: Array, values: Array) -> Contact | None:
    """What is too near to each other at one of these values (T,) of the container, whatever the arm does."""
    world = mechanics.world
    moves, demands = _moves(world, limb, _levers(world, limb)), rules(world, limb, NOTHING)
    environment = np.where(moves[:, None], MAY_TOUCH, demands.environment)
    q = mechanics.put(world.scene.q(tuple(start.tolist()), {}), values)
    return world.contact(q, Rules(environment, demands.pairs[:0], demands.own[:0]))


def _moves(world: World, limb: Limb, levers: tuple) -> NDArray[np.bool_]:
    """Which shapes of the robot arm or fingers move, shape (robot shapes,)."""
    moves = levers[3].any(axis=1)
    moves[world.shapes_of((*limb.palm, *limb.fingers))] = True
    return moves[world.split :]


def _levers(world: World, limb: Limb) -> tuple:
    """Joints that the arm's variables move, these variables, by how much each, and the shapes they carry."""
    arm = np.abs(limb.expansion) > 0
    arm[:, :3] = False
    coordinates, variables = np.nonzero(arm)
    joints = coordinates + 1
    return (
        joints.astype(np.int64),
        variables.astype(np.int64),
        limb.expansion[coordinates, variables],
        world.carried(joints),
    )
