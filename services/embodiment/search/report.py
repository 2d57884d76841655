"""A search that gave up, in words and figures: the stage that nothing passed, and what stood in the way."""

from collections import Counter
from collections.abc import Iterator
from dataclasses import replace

from predicates.case import Diagnosis, Evidence, Kind, Quantity, Search
from sdt_kg.annotation import Drive
from sdt_kg.iri import body_iri, local_name
from sdt_kg.mechanism import JointType
from sdt_kg.naming import few
from services.embodiment.body.world import World
from services.embodiment.certify.drive import rolling
from services.embodiment.hold.kit import stuck
from services.embodiment.search.plan import Planner
from services.embodiment.ways.lattice import CELL

Pair = tuple[int, int]

NAMED = 4  # joints of a list


def refusal(
    planner: Planner, rejected: list[tuple[Diagnosis, ...]], search: Search, budget: float
) -> tuple[Diagnosis, ...]:
    """Why no body motion was found: the stage that was reached last, with the pair most often in contact.

    Where nothing but the search itself was measured, the evidence is its time against its budget [s].
    """
    if planner.proofs.whole is not None:
        return (planner.proofs.whole.diagnosis,)
    if planner.start_contact is not None:
        return (_at_start(planner, *planner.start_contact),)
    stage, counts = _stage(planner, bool(rejected))
    handle = planner.setting.container.handle
    spent = Evidence(Quantity.TIME, search.seconds, budget, "s", entity=handle)
    evidence = _too_fast(planner) or in_the_way(planner.setting.world, counts) or spent
    reason = f"no body motion found for {planner.setting.container.name}: {stage}"
    if evidence.links is not None:
        one, other = evidence.links
        reason += f", most often because {local_name(one)} is too near to {local_name(other)}"
    found = [Diagnosis(Kind.EMBODIMENT, reason, evidence, search=search)]
    if (turning := _turning_elsewhere(planner)) is not None:
        found.append(Diagnosis(Kind.EMBODIMENT, *turning, search=search))
    if not planner.holdings and (farthest := _farthest(planner)) is not None:
        found.append(Diagnosis(Kind.EMBODIMENT, *farthest, search=search))
    found.extend(Diagnosis(Kind.EMBODIMENT, *each, search=search) for each in _lacking(planner))
    found.extend(Diagnosis(Kind.EMBODIMENT, *each, search=search) for each in _by_descent(planner))
    found.extend(Diagnosis(Kind.EMBODIMENT, each, spent, search=search) for each in _beside(planner))
    if planner.proofs.partial is not None:
        found.append(replace(planner.proofs.partial.diagnosis, search=search))
    if planner.late():
        reason = f"the search was stopped after {search.seconds:.1f} s: its budget of {budget:g} s was spent"
        found.append(Diagnosis(Kind.EMBODIMENT, reason, spent, search=search))
    return (*found, *(rejected[-1] if rejected else ()))


def searched(planner: Planner, seconds: float) -> Search:
    """What was tried so far."""
    everyone = planner, *planner.parts
    tallies = [attempt.searcher.tally for one in everyone for attempt in one.attempts]
    return Search(
        seeds=sum(tally.seeds for tally in tallies),
        branches=sum(tally.paths + tally.broken for tally in tallies),
        placements=sum(one.placements for one in everyone),
        seconds=seconds,
    )


def _turning_elsewhere(planner: Planner) -> tuple[str, Evidence] | None:
    """That planning turns the base about a point about which its wheels cannot turn it, if that counts."""
    setting, scene = planner.setting, planner.setting.world.scene
    if setting.drive is not Drive.DIFFERENTIAL:
        return None
    axle, annotation, most = rolling(scene)[1], scene.annotation, setting.tolerances.sideways
    slip = abs(axle) * annotation.base_limits.angular_velocity
    if slip <= most:
        return None
    side = "before" if axle > 0 else "behind"
    reason = (
        f"planning turns the base about sdt:baseBody, its wheels about a line {abs(axle):.3f} m {side} it: "
        "motions in which it turns are refused; give a link amid the wheels as sdt:baseBody"
    )
    entity = body_iri(scene.robot.mechanism.name, annotation.base_body)
    return reason, Evidence(Quantity.SIDEWAYS_VELOCITY, slip, most, "m/s", entity)


def _at_start(planner: Planner, pair: Pair, distance: float) -> Diagnosis:
    world = planner.setting.world
    one, other = (world.body[k] for k in pair)
    x, y, yaw = planner.setting.start
    reason = (
        f"parked at its start pose ({x:.2f} m, {y:.2f} m, {yaw:.2f} rad) the robot's {local_name(one)} "
        f"is in contact with {local_name(other)}"
    )
    bound = world.scene.annotation.overhang
    evidence = Evidence(
        Quantity.DISTANCE, distance, bound, "m", links=(one, other), time=0.0, scope="environment"
    )
    return Diagnosis(Kind.EMBODIMENT, reason, evidence)


def _stage(planner: Planner, rejected: bool) -> tuple[str, Counter[Pair]]:
    """In words, and which pairs of shapes were in contact there."""
    nothing: Counter[Pair] = Counter()
    if rejected:
        return "certification refused every motion that was found", nothing
    if not planner.kits():
        scene = planner.setting.world.scene
        joints = [joint for gripper in scene.annotation.grippers for joint in stuck(scene, gripper)]
        return (
            f"no gripper can close: {', '.join(dict.fromkeys(joints))} may not move, held or without a speed",
            nothing,
        )
    if planner.bar is None:
        return "its handle has no collision geometry to hold", nothing
    if not any(attempt.searcher.tally.grasps for attempt in planner.attempts):
        fits = "fits around the handle and keeps clear as the container moves"
        if any(attempt.fitter.has_room for attempt in planner.attempts):
            fits += ", reaches over it and holds it by faces that look along the way in which fingers close"
        return (
            f"no grasp was found in time that {fits}" if planner.late() else f"no gripper {fits}",
            planner.unfit,
        )
    if planner.rough:
        return _rough(planner), nothing
    return _blocked(planner) if planner.holdings else _unheld(planner)


def _farthest(planner: Planner) -> tuple[str, Evidence] | None:
    """How far the container came in hand at best, and what stopped it."""
    tallies = [attempt.searcher.tally for attempt in planner.attempts]
    ways = [tally.farthest for tally in tallies if tally.farthest is not None]
    if not ways:
        return None
    best = max(ways, key=lambda way: way.index)
    setting, world = planner.setting, planner.setting.world
    values = planner.attempts[0].searcher.problem.values
    at, last, joint = float(values[best.index]), float(values[-1]), setting.container.joint
    unit, links, why = _unit(planner), None, "the reach of the arm within its limits"
    if best.shapes is not None:
        links = world.body[best.shapes[0]], world.body[best.shapes[1]]
        why = f"{local_name(links[0])}, which comes too near to {local_name(links[1])}"
    share = 100 * best.index / (len(values) - 1)
    reason = (
        f"at best {setting.container.name} was followed in hand from {values[0]:.3g} to {at:.3g} {unit}, "
        f"{share:.0f} % of the way to {last:.3g} {unit}; what stopped it: {why}"
    )
    scope = "" if links is None else _scope(world, links)
    return reason, Evidence(Quantity.POSITION, at, last, unit, entity=joint, links=links, scope=scope)


def _lacking(planner: Planner) -> Iterator[tuple[str, Evidence]]:
    """Which part of the way each gripper has no hold of, where several were looked for."""
    container, unit = planner.setting.container, _unit(planner)
    for gripper, (first, last) in () if planner.several is None else planner.several.lacking():
        reason = (
            f"several holds were looked for: gripper {gripper} has none with which {container.name} moves "
            f"from {first:.3g} to {last:.3g} {unit}"
        )
        yield reason, Evidence(Quantity.POSITION, first, last, unit, entity=container.joint)


def _by_descent(planner: Planner) -> Iterator[tuple[str, Evidence]]:
    """Where each gripper has no hold that a descent finds, if they were looked for."""
    world, container, unit = planner.setting.world, planner.setting.container, _unit(planner)
    for lack in () if planner.descended is None else planner.descended.lacking():
        links, scope, (first, last) = None, "", lack.ends
        reason = f"holds were looked for by descent: gripper {lack.gripper} has "
        reason += "some" if lack.held else "none"
        reason += f" with {container.name} at {first:.3g}{f' to {last:.3g}' * (first != last)} {unit}"
        if lack.held:
            reason += ", but no motion through them was found"
        if lack.shapes is not None:
            links = world.body[lack.shapes[0]], world.body[lack.shapes[1]]
            scope = _scope(world, links)
            reason += (
                f": {local_name(links[0])} is too near to {local_name(links[1])} there wherever the arm is"
            )
        yield reason, Evidence(Quantity.POSITION, first, last, unit, container.joint, links, scope=scope)


def _beside(planner: Planner) -> Iterator[str]:
    """That what hangs beside the arm was moved too, if it was."""
    if planner.freed is not None:
        joints = few([*map(local_name, planner.freed.setting.kits.beside)], NAMED)
        yield f"nor was a motion found in which, too, these move out of the way: {joints}"


def _unit(planner: Planner) -> str:
    mechanism, joint = planner.setting.world.scene.kitchen.mechanism, planner.setting.container.joint
    return "m" if mechanism.joint(local_name(joint)).type is JointType.PRISMATIC else "rad"


def _scope(world: World, links: tuple[str, str]) -> str:
    own = all(body.startswith(world.scene.robot_iri) for body in links)
    return "self" if own else "environment"


def _unheld(planner: Planner) -> tuple[str, Counter[Pair]]:
    tallies = [attempt.searcher.tally for attempt in planner.attempts]
    contacts: Counter[tuple[str, int, int]] = Counter()
    for tally in tallies:
        contacts.update(tally.contacts)
    if any(tally.paths for tally in tallies):
        return "no way to hold the handle all along its motion", _pairs(contacts, "path")
    if any(tally.broken for tally in tallies):
        return "the tool can reach the handle, but not follow it within the joint limits", Counter()
    if any(tally.solved for tally in tallies):
        met = _pairs(contacts, "pose") or planner.unfit
        return "no posture that reaches the handle is free of contact", met
    return "the tool reaches no grasp of the handle within the joint limits", Counter()


def _pairs(contacts: Counter[tuple[str, int, int]], stage: str) -> Counter[Pair]:
    return Counter({(a, b): count for (name, a, b), count in contacts.items() if name == stage})


def _rough(planner: Planner) -> str:
    evidence = _too_fast(planner)
    if evidence is None:
        return "the smoothed motion leaves the joint limits"
    needed = f"at best {evidence.value:.2f} times what the joints allow"
    return f"the required times are too short: {needed} (timed: false lets the robot be slower)"


def _too_fast(planner: Planner) -> Evidence | None:
    """The least ratio of a required velocity or acceleration to its limit, over all motions found."""
    if not planner.rough or not planner.setting.motion.timed:
        return None
    speed, acceleration = min((one.excess for one in planner.rough), key=max)
    if max(speed, acceleration) <= 1:
        return None
    quantity = Quantity.VELOCITY if speed > acceleration else Quantity.ACCELERATION
    return Evidence(quantity, max(speed, acceleration), 1.0, "1", entity=planner.setting.robot)


def _blocked(planner: Planner) -> tuple[str, Counter[Pair]]:
    stages = Counter(one.stage for one in planner.blocked)
    words = {
        "leave": "the open hand cannot come straight to the handle",
        "park": "there is no room to fold the arm near the handle",
        "fold": "no path of the arm from its parked posture to the handle was found",
        "drive": "no drive from the start pose to the handle was found",
    }
    stage = stages.most_common(1)[0][0]
    words["drive"] += _shut_off(planner)
    pairs = Counter(one.contact.shapes for one in planner.blocked if one.stage == stage and one.contact)
    return words[stage], pairs


def _shut_off(planner: Planner) -> str:
    """That nothing leads from the handle to the start, as far as steps of base poses tell; else empty."""
    rooms = (attempt.approacher.roads.lattice.room for attempt in planner.attempts)
    room = max(rooms, default=0.0)
    if not room:
        return ""
    return (
        f": parked, the robot gets about on {room:.1f} m² of floor before the handle, and in steps of "
        f"{CELL:g} m nowhere else; the start may lie outside of a closed room"
    )


def in_the_way(world: World, counts: Counter[Pair]) -> Evidence | None:
    """The pair of bodies most often in contact, and how often; how near they came was not measured."""
    if not counts:
        return None
    bodies: Counter[tuple[str, str]] = Counter()
    for (a, b), count in counts.items():
        bodies[world.body[a], world.body[b]] += count
    links, count = bodies.most_common(1)[0]
    return Evidence(Quantity.COUNT, float(count), 0.0, "1", links=links, scope=_scope(world, links))
