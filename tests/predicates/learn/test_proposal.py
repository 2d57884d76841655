"""Φ′: a track that the twin cannot replay, the edited twin, and that Causes then replays it."""

from dataclasses import replace

import numpy as np
import pytest

from predicates.case import Case
from predicates.causes import causes
from predicates.learn import Track, learn
from predicates.learn.explain import explain
from predicates.learn.frames import world_T_of
from predicates.learn.proposal import Proposal, propose
from predicates.learn.record import Key
from sdt_kg.errors import InputError
from sdt_kg.mechanism import JointType
from sdt_kg.task import Task, Verb
from sdt_kg.twin import Twin
from services.physics.chain import follower
from services.physics.observe import Followed, followed, motion_of
from services.physics.oracle import Kinematics
from services.physics.replay import effective_bounds
from services.physics.tree import build
from tests.predicates.learn.observed import seen, stopping
from tests.small import small_twin

TWIN = small_twin("a")
PHYSICS = Kinematics()


def handle(twin: Twin, name: str) -> np.ndarray:
    """Where the container's handle is, in the root frame."""
    container = twin.container(name)
    kitchen = twin.mechanism(twin.environment)
    return world_T_of(kitchen, container.handle.rsplit("/", 1)[-1], twin.state)[:3, 3]


def slid(name: str, way: float, direction: tuple[float, float, float] = (-1, 0, 0)) -> Track:
    return seen(handle(TWIN, name) + stopping(way)[:, None] * np.array(direction))


def turned(name: str, hinge: tuple[float, float], angle: float) -> Track:
    """The handle turned about a vertical axis at x, y."""
    begin, centre = handle(TWIN, name), np.array([*hinge, 0.0])
    arm = begin - centre
    arm[2] = 0
    positions = stopping(angle)
    across = np.cross([0, 0, 1], arm)
    points = centre + np.cos(positions)[:, None] * arm + np.sin(positions)[:, None] * across
    return seen(points + np.array([0, 0, begin[2]]))


def standing(name: str, position: float) -> Twin:
    """The kitchen with a container at a position."""
    return TWIN.at(TWIN.state.moved(TWIN.container(name).joint, position))


def explains(twin: Twin, name: str, track: Track) -> tuple[bool, Followed]:
    model = build(twin.mechanism(twin.environment))
    container = twin.container(name)
    found = followed(model, twin, track, container)
    assert found is not None
    bounds = effective_bounds(model, twin, follower(model, container.joint))
    return found.explains(learn(track).best.scale, bounds), found


def proposed(name: str, track: Track) -> Proposal:
    assert not explains(TWIN, name, track)[0]
    return propose(TWIN, TWIN.container(name), learn(track).best)


def replays(proposal: Proposal, track: Track) -> bool:
    """Causes, of the proposed twin and the motion that the track shows in it."""
    name = proposal.container.name
    holds, found = explains(proposal.twin, name, track)
    motion, _ = motion_of(build(proposal.twin.mechanism(TWIN.environment)), proposal.twin, track, found)
    (answer,) = causes(Case(proposal.twin, motion=motion), PHYSICS)
    return holds and answer.holds


def test_what_the_twin_allows_is_explained_as_a_known_task() -> None:
    track = slid("low_drawer", 0.47)
    holds, found = explains(TWIN, "low_drawer", track)
    motion, stretch = motion_of(build(TWIN.mechanism(TWIN.environment)), TWIN, track, found)
    assert holds
    assert stretch == pytest.approx(1.5, abs=0.3)  # 0.47 m in 4.5 s, at rest at its ends, up to 0.5 m/s
    assert motion.values[-1, 0] == pytest.approx(0.47, abs=0.003)
    explanation = explain(TWIN, motion, PHYSICS)
    assert explanation.tasks == (Task(Verb.OPEN, TWIN.container("low_drawer").iri),)


def test_half_a_way_is_replayed_but_is_no_known_task() -> None:
    track = slid("low_drawer", 0.25)
    _, found = explains(TWIN, "low_drawer", track)
    motion, _ = motion_of(build(TWIN.mechanism(TWIN.environment)), TWIN, track, found)
    explanation = explain(TWIN, motion, PHYSICS)
    assert explanation.replayed
    assert explanation.tasks == ()


def test_a_drawer_that_is_a_door_becomes_one_and_then_replays() -> None:
    track = turned("low_drawer", (1.95, -1.4), 1.2)  # hinge 0.4 m beside the handle, away from the wall
    proposal = proposed("low_drawer", track)
    assert proposal.after.type is JointType.REVOLUTE
    assert proposal.learned.radius == pytest.approx(0.4, abs=0.005)
    assert proposal.after.limits.upper == pytest.approx(1.2, abs=0.02)
    assert handle(proposal.twin, "low_drawer") == pytest.approx(handle(TWIN, "low_drawer"), abs=1e-9)
    assert replays(proposal, track)
    assert TWIN.mechanism(TWIN.environment).joint("low_drawer_joint").type is not JointType.REVOLUTE


def test_a_hinge_at_the_other_side_is_learned_and_then_replays() -> None:
    track = turned("side_door", (2.0, 0.9), -1.2)  # the twin's hinge is at (2, 0)
    proposal = proposed("side_door", track)
    assert proposal.after.type is JointType.REVOLUTE
    assert handle(proposal.twin, "side_door") == pytest.approx(handle(TWIN, "side_door"), abs=1e-9)
    assert replays(proposal, track)


def test_a_drawer_that_goes_farther_gets_wider_limits() -> None:
    proposal = proposed("low_drawer", slid("low_drawer", 0.62))
    assert proposal.after.limits.upper == pytest.approx(0.62, abs=0.005)
    assert proposal.after.limits.lower == 0.0
    assert proposal.twin.container("low_drawer").open_from == pytest.approx(0.9 * 0.62, abs=0.005)
    assert replays(proposal, slid("low_drawer", 0.62))


def test_a_slanted_drawer_is_learned_and_then_replays() -> None:
    track = slid("high_drawer", 0.45, (-0.96, 0.28, 0.0))
    proposal = proposed("high_drawer", track)
    assert proposal.after.limits == proposal.before.limits
    assert proposal.assumptions == ("limits of position are kept: a track does not show where a joint stops",)
    assert replays(proposal, track)


@pytest.mark.parametrize(("begin", "end"), [(0.2, 0.0), (0.35, 0.25), (0.2, 0.4), (0.4, 0.48)])
def test_a_drawer_between_its_limits_opens_where_the_twin_says_whichever_way_it_was_seen(
    begin: float, end: float
) -> None:
    """Seen to be pushed shut, it was taken to open inwards."""
    twin = standing("low_drawer", begin)
    way = stopping(end - begin)[:, None] * np.array([-np.cos(0.2), np.sin(0.2), 0.0])
    proposal = propose(
        twin, twin.container("low_drawer"), learn(seen(handle(twin, "low_drawer") + way, noise=0.001)).best
    )
    assert proposal.after.axis == pytest.approx((-np.cos(0.2), np.sin(0.2), 0), abs=0.05)
    assert (proposal.after.limits.lower, proposal.after.limits.upper) == (0.0, 0.5)
    assert proposal.seen == pytest.approx(sorted((begin, end)), abs=0.003)


def test_a_door_that_was_seen_to_shut_about_another_hinge_is_not_said_to_open() -> None:
    twin = standing("side_door", 0.6)
    begin, hinge = handle(twin, "side_door"), np.array([2.0, -0.2, 0.0])  # the twin's is at (2, 0)
    arm = (begin - hinge) * [1, 1, 0]
    positions = -stopping(0.5)
    across = np.cross([0, 0, 1], arm)
    points = hinge + np.cos(positions)[:, None] * arm + np.sin(positions)[:, None] * across
    track = seen(points + np.array([0, 0, begin[2]]), noise=0.001)
    proposal = propose(twin, twin.container("side_door"), learn(track).best)
    assert proposal.after.axis == pytest.approx((0, 0, 1), abs=0.05)
    assert proposal.seen == pytest.approx((0.1, 0.6), abs=0.02)


def test_where_nothing_tells_which_way_it_opens_that_is_an_assumption() -> None:
    twin = standing("low_drawer", 0.2)
    way = stopping(0.3)[:, None] * np.array([0.0, 1.0, 0.0])
    track = seen(handle(twin, "low_drawer") + way)
    proposal = propose(twin, twin.container("low_drawer"), learn(track).best)
    assert "it is taken to have been opened: the track does not say" in proposal.assumptions


def test_what_causes_says_of_a_learned_joint_it_says_with_its_uncertainty() -> None:
    track = slid("high_drawer", 0.45, (-0.96, 0.28, 0.0))
    proposal = proposed("high_drawer", track)
    twin, axis = proposal.twin, proposal.learned.deviations["axis"]
    (answer,) = causes(Case(twin, task=Task(Verb.OPEN, twin.container("high_drawer").iri)), PHYSICS)
    (note,) = (each for each in answer.notes if "learned" in each)
    assert note.startswith(f"high_drawer_joint is learned from an observed track: axis ± {axis:.2g} rad")
    assert f"seen from 0 to {proposal.seen[1]:.4g} m; limits of position are kept" in note
    (other,) = causes(Case(twin, task=Task(Verb.OPEN, twin.container("low_drawer").iri)), PHYSICS)
    assert not any("learned" in each for each in other.notes)


def test_what_is_learned_has_a_name_of_its_own_for_other_forces_orientations_and_states() -> None:
    track, container = slid("low_drawer", 0.4), TWIN.container("low_drawer")
    ones = np.ones((len(track.positions), 3))
    tracks = (
        track,
        replace(track, forces=ones),
        replace(track, forces=-ones),
        replace(track, orientations=ones),
    )
    keys = {Key.of(TWIN, container, each).iri for each in tracks}
    assert len(keys) == 4
    assert Key.of(standing("low_drawer", 0.1), container, track).iri not in keys
    assert Key.of(TWIN, container, replace(track, forces=ones.copy())).iri in keys


def test_a_coupled_joint_is_not_edited_alone() -> None:
    track = learn(slid("folding_door", 0.3)).best
    with pytest.raises(InputError, match="joint 'folding_door_joint' is coupled to others"):
        propose(TWIN, TWIN.container("folding_door"), track)


def test_what_stands_still_teaches_nothing() -> None:
    still = learn(slid("low_drawer", 0.0)).best
    with pytest.raises(InputError, match="what was seen does not move"):
        propose(TWIN, TWIN.container("low_drawer"), still)


def test_noise_before_the_motion_is_no_travel_below_the_closed_stop() -> None:
    """A lower limit of a millimetre below 0 would put the container outside D_artic for nothing."""
    for seed in range(20):
        way = stopping(0.4, still=200)[:, None] * np.array([-np.cos(0.06), np.sin(0.06), 0.0])
        track = seen(handle(TWIN, "low_drawer") + way, seed, 0.002)
        made = propose(TWIN, TWIN.container("low_drawer"), learn(track).best)
        assert made.seen[0] == made.after.limits.lower == 0.0
