"""What of kitchen and robot is assumed, or has no shape: nothing can collide with that; verdicts say so."""

from collections.abc import Iterator
from itertools import chain

from sdt_kg.annotation import Drive
from sdt_kg.iri import local_name
from sdt_kg.twin import Container
from services.embodiment.floor import aloft
from services.physics.model import Scene

UNSEEN = "which nothing can collide with"


def of_models(scene: Scene, container: Container, drive: Drive) -> tuple[str, ...]:
    """What import and annotations noticed, and what has no shape where one would be expected."""
    models = (scene.kitchen.mechanism.notes, scene.robot.mechanism.notes, scene.annotation.notes_of(drive))
    told = dict.fromkeys(chain.from_iterable(models))
    return (*told, *aloft(scene), *_arms(scene), *_panel(scene, container))


def _arms(scene: Scene) -> Iterator[str]:
    """Grippers on an arm of which no link has a shape; the hand counts where it is all of it."""
    shaped = {one.joint for one in scene.solids}
    for gripper in scene.annotation.grippers:
        hand, _ = scene.robot.attached[gripper.tool_body]
        above = [joint for joint in scene.model.supports[hand] if joint > scene.base[-1] + 1]
        if above and shaped.isdisjoint(above[:-1] or above):
            yield f"the arm of gripper '{gripper.name}' has no shape at all, {UNSEEN}"


def _panel(scene: Scene, container: Container) -> tuple[str, ...]:
    """That of what the container moves nothing but its handles has a shape."""
    handles = {container.handle, *container.more_handles}
    joint, _ = scene.kitchen.attached[local_name(container.handle)]
    bodies = {one.body for one in scene.solids if one.joint == joint}
    if bodies - handles:
        return ()
    return (f"'{container.name}' has no shape but that of its handle, {UNSEEN}",)
