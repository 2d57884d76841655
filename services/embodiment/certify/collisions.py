"""Which pairs of bodies must keep which distance, and what the sweep over them says."""

import numpy as np

from predicates.case import Evidence, Quantity
from sdt_kg.iri import body_iri, local_name
from services.embodiment.certify.clearance import NEAR, Distance, Pairs, Sweep
from services.embodiment.certify.findings import Findings, Violation
from services.embodiment.certify.hold import Hold
from services.embodiment.certify.subject import Subject
from services.embodiment.certify.tolerances import Tolerances
from services.physics.model import Scene

BLOCK = 8  # pieces joined in the first look at pairs of robot and kitchen


def collisions(checked: Subject, hold: Hold | None) -> Findings:
    """Robot against itself and against the kitchen as it moves.

    The only contact allowed is that of the holding gripper's fingers with the container's handle,
    from the time on at which the tool is in its grasp.
    """
    findings, scene, tolerances, timeline = Findings(), checked.scene, checked.tolerances, checked.timeline
    block = max(0, timeline.depth - int(np.log2(BLOCK)))
    for scope, pairs, level in (
        ("self", _self(scene, tolerances), 0),
        ("environment", _environment(scene, hold, tolerances), block),
    ):
        if len(pairs.shapes):
            sweep = Sweep(timeline, checked.kinematics, checked.shapes, pairs)
            sweep.run(level, tolerances.resolution)
            findings.add(_findings(scene, sweep, scope))
    return findings


def _self(scene: Scene, tolerances: Tolerances) -> Pairs:
    least = np.full(len(scene.self_pairs), tolerances.margin + scene.annotation.overhang)
    return Pairs(scene.self_pairs, least, least, np.inf)


def _environment(scene: Scene, hold: Hold | None, tolerances: Tolerances) -> Pairs:
    pairs = scene.environment_pairs
    least = np.full(len(pairs), tolerances.margin + scene.annotation.overhang)
    if hold is None:
        return Pairs(pairs, least, least, np.inf)
    robot = scene.robot.mechanism.name
    fingers = {body_iri(robot, name) for name in hold.gripper.fingers}
    touching = np.array(
        [
            scene.solids[one].body in fingers and scene.solids[other].body == hold.container.handle
            for one, other in pairs
        ]
    )
    held = np.where(touching, -tolerances.contact, least)
    return Pairs(pairs, least, held, hold.arrived())


def _findings(scene: Scene, sweep: Sweep, scope: str) -> Findings:
    found, findings = sweep.found, Findings()
    if found.gave_up is not None:
        reason = f"the motion is too fast between samples to be checked for contact ({scope})"
        evidence = Evidence(Quantity.TIME, found.gave_up, found.gave_up, "s", time=found.gave_up, scope=scope)
        findings.violations.append(Violation(f"too fast to be checked: {scope}", reason, evidence, 0.0))
    if found.first is not None:
        worst = found.worst or found.first
        findings.violations.extend(_violation(scene, one, scope) for one in (found.first, worst))
    elif found.gave_up is None:
        nearest = NEAR if found.worst is None else found.worst.value
        findings.figures[f"smallest distance, {scope}"] = (nearest, "m")
    findings.figures[f"distance queries, {scope}"] = (float(found.queries), "1")
    return findings


def _violation(scene: Scene, distance: Distance, scope: str) -> Violation:
    one, other = (scene.solids[i].body for i in distance.pair)
    names = f"{local_name(one)} and {local_name(other)}"
    millimetres = abs(distance.value) * 1000
    if distance.value < 0:
        reason = f"{names} are {millimetres:.1f} mm in each other"
    elif distance.resolved:
        reason = f"{names} come as near as {millimetres:.1f} mm"
    else:
        reason = f"{names} are {millimetres:.2f} mm apart, closer than the check can resolve"
    evidence = Evidence(
        Quantity.DISTANCE,
        distance.value,
        distance.least,
        "m",
        links=(one, other),
        time=distance.time,
        scope=scope,
    )
    return Violation(f"collision: {scope}", reason, evidence, distance.least - distance.value)
