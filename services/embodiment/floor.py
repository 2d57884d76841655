"""Robots stand on the plane z = 0 of the kitchen's root frame, so that is where its floor has to be."""

import numpy as np
import pinocchio as pin  # pyright: ignore[reportMissingImports]  # found through a .pth file

from sdt_kg.errors import InputError
from sdt_kg.iri import local_name
from services.physics.model import Scene


def check_floor(scene: Scene) -> None:
    """No handle of the kitchen is wholly below the floor.

    Judged all the same, a handle at table height lies on the floor, and one near the floor out of reach.

    Raises:
        InputError: One is: the kitchen's root frame is not on its floor, but at its worktop, say.
    """
    pin.forwardKinematics(scene.model, scene.data, scene.q((0.0, 0.0, 0.0), {}))
    handles = {each.handle for each in scene.twin.containers()}
    tops: dict[str, float] = {}
    for one in scene.solids:
        if one.body in handles:
            world_T_shape = scene.data.oMi[one.joint] * one.joint_T_shape
            reach = np.abs(world_T_shape.rotation[2]) @ one.half
            top = float(scene.data.oMi[one.joint].act(one.centre)[2] + reach)
            tops[one.body] = max(top, tops.get(one.body, -np.inf))
    handle = min(tops, key=lambda each: tops[each], default=None)
    if handle is not None and tops[handle] < 0:
        kitchen, down = scene.kitchen.mechanism.name, -tops[handle]
        raise InputError(
            f"{local_name(handle)} of kitchen '{kitchen}' is {down:.3g} m below z = 0 of the kitchen's root "
            "frame, on which robots stand",
            allowed="a root frame on the floor",
            remedy="give the model a link on the floor as its root, with a fixed joint up to the present one",
        )
