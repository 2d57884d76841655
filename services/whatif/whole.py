"""Changes of which there is no half: another robot or kitchen, a stuck joint, a gripper less."""

from collections.abc import Callable
from dataclasses import replace
from typing import Final

from sdt_kg.annotation import Drive
from sdt_kg.entities import Replacement
from sdt_kg.errors import InputError
from sdt_kg.history import Rewritten, brought
from sdt_kg.iri import SDT, local_name
from sdt_kg.load import load_twin, model_name
from services.edits import parse_edit
from services.whatif.payload import carrying
from services.whatif.world import World


def _jammed(world: World, name: str) -> World:
    joint = local_name(world.service.twin.container(name).active_joint)
    return world.edited(f"set:{joint}.velocityLimit=0")


def _broken(world: World, name: str) -> World:
    """The robot has the gripper no longer."""
    twin, robot = world.service.twin, world.robot_iri
    names = [each.name for each in twin.robot(robot).grippers]
    if name not in names:
        raise InputError(f"no gripper '{name}'", allowed=", ".join(names))
    if len(names) == 1:
        raise InputError(f"'{name}' is the robot's only gripper", allowed="a robot with another one left")
    triples = twin.entities.store.triples(twin.entities.asserted[robot])
    lost = frozenset(
        each for each in triples if each[1] == SDT + "hasGripper" and local_name(each[2].value) == name
    )
    by = Replacement(robot, lost, frozenset(), f"gripper {name} is broken")
    return world.with_twin(Rewritten(by).applied(twin))


def _loaded(world: World, text: str) -> World:
    """A gripper carries something, so that it holds no handle, and what it carries touches nothing."""
    name, equals, value = text.partition("=")
    if not equals:
        raise InputError(f"'payload:{text}' says no size", allowed="payload:GRIPPER=SX,SY,SZ[,KG]")
    without = _broken(world, name)
    (gripper,) = (each for each in world.service.twin.robot(world.robot_iri).grippers if each.name == name)
    twin = without.service.twin
    return without.with_twin(carrying(twin, world.robot_iri, gripper, value).applied(twin))


def _other_robot(world: World, name: str) -> World:
    twin = world.service.twin
    if model_name(name) not in [twin.name(each) for each in twin.robots]:
        twin = parse_edit(twin, f"robot:{name}").applied(twin)
    return replace(world.with_models(twin), robot=name)


def _other_kitchen(world: World, name: str) -> World:
    """The robot comes along as it is, whatever was changed of it before."""
    return world.with_models(brought(world.service.twin, world.robot_iri).applied(load_twin(name)))


def _other_drive(world: World, name: str) -> World:
    try:
        return world.under(drive=Drive(name))
    except ValueError:
        raise InputError(f"no drive '{name}'", allowed=", ".join(each.value for each in Drive)) from None


WHOLE: Final[dict[str, Callable[[World, str], World]]] = {
    "robot": _other_robot,
    "kitchen": _other_kitchen,
    "drive": _other_drive,
    "jam": _jammed,
    "broken": _broken,
    "payload": _loaded,
}
"""Kind → the world after it."""
