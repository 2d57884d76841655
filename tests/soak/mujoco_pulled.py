"""A motion played in MuJoCo with its container free: nothing moves that but what fingers press and rub."""

from copy import copy

import mujoco
import numpy as np
from numpy.typing import NDArray

from tests.soak.audit import Way
from tests.soak.audit_holds import MOVES
from tests.soak.mujoco_replay import PREFIX, Scene, positions_of

Array = NDArray[np.float64]

STEP = 5e-4  # [s]
BEFORE = 0.5  # [s] of the motion that are played before the container moves
PRESSING = 0.3  # [s] before it moves in which fingers come to press
STIFF, DAMPED = 15e3, 170.0  # [N/m], [N s/m] of a finger against where it is told to be
FINGER, CONTAINER = 1.0, 5.0  # [kg]
DRIVEN = 1e6  # [kg or kg m²] of what goes its way whatever it meets
RESISTS = {"prismatic": (2.0, 1.0), "revolute": (0.3, 0.2)}
"""Dry friction [N or N m] and damping [N s/m or N m s] of a container's joint."""
HARD = 0.004  # [s] in which contacts give way


class Play:
    """A robot that goes its way, whatever it meets, but for its fingers, which give; and a free container.

    Each finger is a spring of its own, told to close farther than the motion has it, by so much that it
    presses with what is asked if the handle is there. What of the kitchen does not go with the container
    is not there for contacts; a certificate has nothing to say about it that `replayed` does not see.

    Args:
        scene: Whose model is changed.
        way: The motion.
        press: What a finger presses with [N].
        rub: Coefficient of friction.
    """

    def __init__(self, scene: Scene, way: Way, press: float, rub: float) -> None:
        self._scene, self._way, self._stage = scene, way, way.stage
        self._model, self._data = scene.model, scene.data
        mujoco.mj_resetData(self._model, self._data)
        moving = np.abs((there := way.container()) - there[0]) > MOVES
        self._begin = float(way.times[np.argmax(moving)])
        self._told, earlier = positions_of(self._timed()), positions_of(way)
        self._free = self._moving_with_the_container()
        self._tips = self._fingers()
        at_first = round(BEFORE / STEP)
        scene.put({name: value[at_first] for name, value in self._told.items()})
        link, link_T_tool, _ = way.hand
        tool = (scene.pose(PREFIX + link) @ link_T_tool)[:3, 3]
        self._lever = {each: self._lever_of(each, tool) for each in self._tips}
        for name, lever in self._lever.items():
            held, before = self._told[name][at_first], earlier[name][way.times < self._begin]
            opened = before[np.argmax(np.abs(before - held))]
            farther = np.sign(held - opened) * press / STIFF / lever
            since = np.arange(len(self._told[name])) * STEP - BEFORE + PRESSING
            self._told[name] = self._told[name] + farther * np.clip(since / (PRESSING / 2), 0.0, 1.0)
        self._prepare(rub)

    def ends(self) -> tuple[float, float]:
        """Where the container comes to, and where the motion has it in the end [rad or m]."""
        model, data, told = self._model, self._data, self._told
        tips = {tip for each in self._tips.values() for tip in each}
        driven = [
            name for name in told if name not in self._free and name not in self._tips and name not in tips
        ]
        ways = np.stack([told[name] for name in driven], axis=1)
        speeds = np.gradient(ways, STEP, axis=0)
        q, v = (
            np.array([getattr(model.joint(name), key)[0] for name in driven]) for key in ("qposadr", "dofadr")
        )
        for name in {*self._free, *self._tips}:
            data.joint(name).qpos, data.joint(name).qvel = told[name][0], 0.0
        for k in range(len(ways)):
            data.qpos[q], data.qvel[v] = ways[k], speeds[k]
            for name in self._free if k < BEFORE / STEP else ():  # until it is held it stays, as in D_artic
                data.joint(name).qpos, data.joint(name).qvel = told[name][0], 0.0
            for name, carried in self._tips.items():
                joint, lever = data.joint(name), self._lever[name]
                joint.qfrc_applied = STIFF * lever**2 * (told[name][k] - joint.qpos)
                for tip, ratio in carried.items():
                    data.joint(tip).qpos, data.joint(tip).qvel = ratio * joint.qpos, ratio * joint.qvel
            mujoco.mj_step(model, data)
        joint, sign = self._stage.joint, self._stage.kitchen.sign[self._stage.joint]
        return float(sign * data.joint(joint).qpos[0]), float(sign * told[joint][-1])

    def _timed(self) -> Way:
        """The motion from shortly before the container moves, at the times of the simulation."""
        way = copy(self._way)
        way.times = np.arange(self._begin - BEFORE, way.knots[-1], STEP).clip(way.knots[0])
        return way

    def _moving_with_the_container(self) -> set[str]:
        """Joints of the kitchen that move together."""
        joint, follows = self._stage.joint, self._stage.kitchen.mimicked()
        source = follows[joint][0] if joint in follows else joint
        return {source, *(name for name, (other, _, _) in follows.items() if other == source)}

    def _fingers(self) -> dict[str, dict[str, float]]:
        """Joint of a finger next to the palm → joints behind it, which follow, with their ratio to it."""
        robot = self._stage.robot
        palm, follows = robot.rigid(self._way.hand[0]), robot.mimicked()
        found = dict[str, dict[str, float]]()
        for finger in self._way.hand[2]:
            joints, link = list[str](), robot.rigid(finger)
            while link != palm:
                joints.append(robot.parent[link])
                link = robot.rigid(robot.urdf.ends(robot.parent[link])[0])
            *behind, first = joints
            own = follows[first][1] if first in follows else 1.0
            found.setdefault(PREFIX + first, {}).update(
                {PREFIX + tip: follows[tip][1] / own for tip in behind}
            )
        return found

    def _lever_of(self, name: str, tool: Array) -> float:
        """How far a finger goes at the tool by one rad or m of its joint [m]."""
        if self._stage.robot.kind(name.removeprefix(PREFIX)) == "prismatic":
            return 1.0
        joint = self._data.joint(name)
        return float(np.linalg.norm(np.cross(joint.xaxis, tool - joint.xanchor)))

    def _prepare(self, rub: float) -> None:
        model, stage = self._model, self._stage
        model.opt.timestep, model.opt.impratio = STEP, 1.0
        model.opt.integrator = mujoco.mjtIntegrator.mjINT_IMPLICITFAST
        model.opt.cone = mujoco.mjtCone.mjCONE_ELLIPTIC
        names = [mujoco.mj_id2name(model, mujoco.mjtObj.mjOBJ_JOINT, k) for k in range(model.njnt)]
        bodies = {int(model.jnt_bodyid[names.index(joint)]) for joint in self._free}
        moved = np.array([not bodies.isdisjoint(_above(model, body)) for body in range(model.nbody)])
        share = CONTAINER / model.body_mass[moved].sum()
        model.body_mass[moved] *= share
        model.body_inertia[moved] *= share
        robots = np.array([name.startswith((PREFIX, "base")) for name in self._scene.names])[
            model.geom_bodyid
        ]
        model.geom_contype[:], model.geom_conaffinity[:] = robots, moved[model.geom_bodyid]
        model.geom_friction[:, 0], model.geom_condim[:], model.geom_solref[:, 0] = rub, 4, HARD
        model.jnt_limited[:] = 0
        model.dof_armature[:] = DRIVEN
        for name, lever in self._lever.items():
            finger = model.joint(name)
            model.body_mass[finger.bodyid], model.body_inertia[finger.bodyid] = 0.05, 1e-4
            finger.armature, finger.damping = FINGER * lever**2, DAMPED * lever**2
        for name in self._free:
            kind = stage.kitchen.kind(name)
            model.joint(name).armature = 0.0
            model.joint(name).frictionloss, model.joint(name).damping = RESISTS[kind]
        for k in range(model.neq):
            self._data.eq_active[k] = names[model.eq_obj1id[k]] in self._free
        mujoco.mj_setConst(model, mujoco.MjData(model))


def _above(model: mujoco.MjModel, body: int) -> set[int]:
    """A body and those that carry it."""
    found = set[int]()
    while body:
        found.add(body)
        body = int(model.body_parentid[body])
    return found
