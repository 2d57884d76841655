"""Mode 3: which joint moves what was seen."""

import math
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from predicates.learn import Articulation, Track, learn
from predicates.learn.fitting.priors import Plumb
from sdt_kg.errors import MotionError
from sdt_kg.mechanism import JointType
from services.tracks import read_track
from tests.predicates.learn.observed import about_z, door, drawer, seen, stopping


def best(joint_type: JointType, *args: object, **known: object) -> Articulation:
    joint = learn(seen(*args, **known)).best  # type: ignore[arg-type]
    assert joint.joint_type is joint_type
    return joint


@pytest.mark.parametrize("noise", [0.0, 0.0005, 0.001, 0.002, 0.004])
def test_what_does_not_move_is_fixed_whatever_the_noise(noise: float) -> None:
    for seed in range(3):
        joint = best(JointType.FIXED, np.tile([1.0, 0.5, 0.8], (100, 1)), seed, noise)
    assert joint.origin == pytest.approx([1.0, 0.5, 0.8], abs=0.002)


def test_what_a_tracker_wanders_by_is_no_motion() -> None:
    for seed in range(5):
        generator = np.random.default_rng(seed)
        wandering = np.zeros((300, 3))
        for k in range(1, 300):
            wandering[k] = 0.9 * wandering[k - 1] + generator.normal(0, 0.002 * math.sqrt(1 - 0.9**2), 3)
        best(JointType.FIXED, wandering, seed, 0.001)


@pytest.mark.parametrize("noise", [0.0002, 0.001, 0.003])
def test_three_centimetres_of_a_drawer_are_motion(noise: float) -> None:
    found = [learn(seen(drawer(stopping(0.03)), seed, noise)).best.joint_type for seed in range(5)]
    assert found == [JointType.PRISMATIC] * 5


@pytest.mark.parametrize(("travel", "samples"), [(0.03, 200), (0.05, 20)])
def test_noise_of_single_samples_is_no_reason_to_doubt_what_many_show(travel: float, samples: int) -> None:
    """Samples that differ by noise alone say more together than those that a hand pulls aside together."""
    positions = drawer(np.linspace(0, travel, samples))
    found = [learn(seen(positions, seed, 0.003)) for seed in range(8)]
    moves = [
        sum(p for p, one in zip(each.probabilities, each.candidates, strict=True) if one.curve is not None)
        for each in found
    ]
    assert sum(each > 0.5 for each in moves) >= 6


@pytest.mark.parametrize("travel", [0.01, 0.02])
def test_what_is_taken_to_be_fixed_may_have_moved_by_less_than_is_told(travel: float) -> None:
    """A tracker that wanders looks like this; what is told of such a point is only how far it stays."""
    for seed in range(3):
        joint = best(JointType.FIXED, drawer(stopping(travel)), seed, 0.003)
        assert travel < joint.extent < travel + 12 * 0.003
    assert best(JointType.FIXED, np.zeros((100, 3)), noise=0.0005).extent < 0.006


def test_samples_that_are_all_the_same_do_not_say_that_nothing_moved_at_all() -> None:
    # A tracker that tells millimetres: "moved less than 0 mm" was no claim that the samples bear.
    assert best(JointType.FIXED, np.round(drawer(stopping(0.0004)), 3), noise=0.0).extent == 0.001


@pytest.mark.parametrize("noise", [0.0005, 0.001, 0.002, 0.004])
@pytest.mark.parametrize("samples", [200, 500])
def test_what_goes_steadily_by_five_noise_levels_is_not_fixed_for_sure(noise: float, samples: int) -> None:
    positions = drawer(np.linspace(0, 5 * noise, samples))
    for seed in range(8):
        assert standstill(seen(positions, seed, noise)) <= 0.5 + 1e-9


@pytest.mark.parametrize("noise", [0.0002, 0.001, 0.004])
@pytest.mark.parametrize("samples", [30, 200, 500])
def test_what_noise_alone_moves_is_fixed_for_sure(noise: float, samples: int) -> None:
    for seed in range(20):
        assert standstill(seen(np.tile([1.0, 0.5, 0.8], (samples, 1)), seed, noise)) > 0.99


@pytest.mark.parametrize(
    ("travel", "noise", "samples"),
    [(0.02, 0.005, 60), (0.005, 0.0005, 60), (0.01, 0.0005, 20), (0.0015, 0.0002, 60), (0.05, 0.005, 20)],
)
@pytest.mark.parametrize("way", ["there", "there and back", "twice"])
def test_what_is_moved_a_little_is_not_fixed_for_sure(
    travel: float, noise: float, samples: int, way: str
) -> None:
    time = np.linspace(0, 1, samples)
    share = {"there": time, "there and back": np.sin(np.pi * time), "twice": np.sin(2 * np.pi * time) ** 2}
    found = [standstill(seen(drawer(travel * share[way]), seed, noise)) for seed in range(5)]
    assert max(found) <= 0.5 + 1e-9


def test_standstill_is_not_sure_where_noise_would_hide_two_centimetres() -> None:
    still = np.tile([1.0, 0.5, 0.8], (20, 1))
    assert not any(learn(seen(still, seed, 0.008)).sure for seed in range(8))


@pytest.mark.parametrize(("radius", "way"), [(0.9, 0.2), (1.2, 0.1)])
def test_a_wide_arc_that_noise_may_hide_is_no_drawer_for_sure(radius: float, way: float) -> None:
    positions = door(np.linspace(0, way / radius, 60), radius)
    assert not any(learn(seen(positions, seed, 0.005)).sure for seed in range(20))


@pytest.mark.parametrize("samples", [60, 300])
def test_outliers_about_what_stands_still_are_no_motion(samples: int) -> None:
    still = np.tile([1.0, 0.5, 0.8], (samples, 1))
    found = [learn(seen(still, seed, 0.0005, outliers=0.2)).best.joint_type for seed in range(20)]
    assert found == [JointType.FIXED] * 20


def test_a_tracker_that_drifts_by_a_millimetre_is_no_motion() -> None:
    positions = drawer(np.linspace(0, 0.001, 200))
    assert standstill(seen(positions, noise=0.0001)) > 0.99


def standstill(track: Track) -> float:
    """Probability that nothing moves."""
    found = learn(track)
    return next(
        p
        for each, p in zip(found.candidates, found.probabilities, strict=True)
        if each.joint_type is JointType.FIXED
    )


def test_a_few_samples_with_outliers_are_no_proof_of_standstill() -> None:
    """Noise is told by the calmest samples: outliers are no reason to expect a wide scatter."""
    positions = drawer(np.linspace(0, 0.3, 20))
    found = [learn(seen(positions, seed, 0.0005, outliers=0.3)).best.joint_type for seed in range(8)]
    assert found == [JointType.PRISMATIC] * 8


def test_twenty_samples_of_a_door_are_known_through_six_outliers() -> None:
    angles = np.linspace(0, 1.0, 20)
    found = [learn(seen(door(angles), seed, 0.002, outliers=0.3)).best.joint_type for seed in range(8)]
    assert found == [JointType.REVOLUTE] * 8


def test_orientations_choose_among_axes_that_the_path_leaves_open() -> None:
    """A short arc whose plane the points hardly show: 17 degrees about a level axis, seen in orientations."""
    angle = stopping(0.3, still=20, moving=20)
    level = np.column_stack([0.28 * np.sin(angle), 0 * angle, 0.28 * np.cos(angle)])
    half = np.sin(angle / 2)
    turns = np.column_stack([0 * half, half, 0 * half, np.cos(angle / 2)])
    learned = learn(replace(seen(level, noise=0.001), orientations=turns))
    assert learned.best.joint_type is JointType.REVOLUTE
    assert abs(learned.best.axis @ [0.0, 1.0, 0.0]) > 0.99


def test_a_drawer_is_prismatic_along_its_axis_with_the_range_that_was_seen() -> None:
    joint = best(JointType.PRISMATIC, drawer(stopping(0.4)))
    assert joint.axis == pytest.approx([0.6, -0.8, 0.0], abs=0.01)
    assert joint.origin == pytest.approx([0.5, 0.2, 0.7], abs=0.002)
    assert joint.limits == pytest.approx((0.0, 0.4), abs=0.004)
    assert joint.residual_rms == pytest.approx(0.002 * np.sqrt(2), rel=0.15)


@pytest.mark.parametrize("radius", [0.2, 0.4, 0.8])
def test_a_door_is_revolute_about_its_hinge(radius: float) -> None:
    joint = best(JointType.REVOLUTE, door(stopping(1.4), radius))
    assert joint.axis == pytest.approx([0.0, 0.0, 1.0], abs=0.01)
    assert joint.origin == pytest.approx([1.0, 0.2, 0.9], abs=0.005)
    assert joint.radius == pytest.approx(radius, abs=0.005)
    assert joint.limits == pytest.approx((0.0, 1.4), abs=0.02)


@pytest.mark.parametrize("way", [1, -1])
def test_a_hinge_that_comes_round_to_where_it_began_has_turned_all_the_way(way: int) -> None:
    turn = np.deg2rad(359.9)
    joint = best(JointType.REVOLUTE, door(way * np.linspace(0, turn, 400)), noise=0.001)
    assert joint.limits == pytest.approx((0.0, turn), abs=0.03)


def test_thirty_samples_without_standstill_keep_their_range() -> None:
    joint = best(JointType.PRISMATIC, drawer(np.linspace(0, 0.4, 30)), noise=0.0)
    assert joint.limits == pytest.approx((0.0, 0.4), abs=1e-6)


def test_positions_give_back_the_points_of_the_path() -> None:
    positions = stopping(1.4)
    joint = best(JointType.REVOLUTE, door(positions), noise=1e-5)
    assert joint.point(positions) == pytest.approx(door(positions), abs=1e-3)
    assert joint.positions == pytest.approx(positions, abs=1e-3)


def test_closing_begins_at_zero_too_and_the_axis_points_the_other_way() -> None:
    joint = best(JointType.REVOLUTE, door(1.4 - stopping(1.4)))
    assert joint.axis == pytest.approx([0.0, 0.0, -1.0], abs=0.01)
    assert joint.limits == pytest.approx((0.0, 1.4), abs=0.02)


def test_a_third_of_outliers_and_a_long_standstill_change_little() -> None:
    joint = best(JointType.REVOLUTE, door(stopping(1.4, still=400)), outliers=0.33)
    assert joint.origin == pytest.approx([1.0, 0.2, 0.9], abs=0.015)
    assert joint.limits == pytest.approx((0.0, 1.4), abs=0.04)
    assert joint.outliers == pytest.approx(0.33 * 950, rel=0.3)


def test_a_drawer_is_no_arc_of_five_metres() -> None:
    arc = np.linspace(0, 0.09, 200)
    bent = np.column_stack([5 * np.sin(arc), 5 * (1 - np.cos(arc)), np.full(200, 0.7)])  # 20 mm off a line
    assert learn(seen(bent[:100])).best.joint_type is JointType.PRISMATIC


@pytest.mark.parametrize("noise", [0.005, 0.035])
def test_orientations_that_hardly_show_a_hinge_make_nobody_sure_of_a_drawer(noise: float) -> None:
    """A door turns by five degrees; noise of many samples spreads by ten, and turns about no axis."""
    positions = np.linspace(0, 0.085, 120)
    for seed in range(12):
        track = seen(door(positions, 0.5), seed, 0.001)
        learned = learn(replace(track, orientations=about_z(positions, seed + 50, noise)))
        assert learned.best.joint_type is JointType.REVOLUTE or not learned.sure, seed


def test_orientations_tell_a_short_arc_from_a_drawer() -> None:
    positions = stopping(0.25)
    track = seen(door(positions, 0.3))
    turned = learn(replace(track, orientations=about_z(positions)))
    slid = learn(replace(track, orientations=about_z(np.zeros(len(positions)))))
    assert turned.best.joint_type is JointType.REVOLUTE
    assert turned.best.radius == pytest.approx(0.3, abs=0.03)
    assert slid.best.joint_type is JointType.PRISMATIC
    assert turned.probabilities[0] > 0.999


def test_without_a_known_up_a_slanted_hinge_is_found() -> None:
    slant = np.linalg.qr(np.array([[1.0, 2, 3], [0, 1, 4], [5, 6, 0]]))[0]
    track = seen(door(stopping(1.4)) @ slant.T)
    for learned in (learn(track, up=None), learn(track)):
        assert learned.best.joint_type is JointType.REVOLUTE
        assert abs(learned.best.axis @ slant[:, 2]) == pytest.approx(1.0, abs=1e-3)


def test_an_axis_that_gravity_turns_is_as_uncertain_as_it_was_turned() -> None:
    """A short arc about an axis 20 degrees from level: gravity would have it level."""
    slant = Rotation.from_euler("y", 70, degrees=True) * Rotation.from_euler("z", 40, degrees=True)
    points = slant.apply(door(np.linspace(0, 0.45, 100), 0.45))
    found = [learn(seen(points, seed, 0.003)).best for seed in range(8)]
    turned = [each for each in found if each.plumb is Plumb.HORIZONTAL]
    assert turned, "or this tests nothing"
    for each in turned:
        off = math.acos(abs(each.axis @ slant.apply([0.0, 0.0, 1.0])))
        assert off < 3 * each.deviations["axis"]
        assert each.swung[0] == pytest.approx(off, abs=4 * each.swung[1])


def test_deviations_cover_the_truth() -> None:
    truth, found = 0.4, [learn(seen(door(stopping(1.0)), seed)).best for seed in range(20)]
    errors = [abs(each.radius - truth) / each.deviations["radius"] for each in found]
    assert max(errors) < 3
    assert all(each.deviations["radius"] < 0.02 for each in found)


@pytest.mark.parametrize("opened", [0.4, 0.7, 1.2])
def test_the_range_of_a_short_arc_is_as_uncertain_as_its_radius(opened: float) -> None:
    found = [best(JointType.REVOLUTE, door(stopping(opened), 0.45), seed, 0.001) for seed in range(12)]
    off = [(each.limits[1] - opened) / each.deviations["limits"] for each in found]
    assert np.abs(off).max() < 4
    assert math.sqrt(np.mean(np.square(off))) > 0.1  # nor is it so wide that it says nothing


@pytest.mark.parametrize("at", [70, 120, 170])
def test_what_is_seen_beyond_the_hinge_is_no_turn_of_the_door(at: int) -> None:
    # Two samples off the path, a third and two thirds of a turn on: the next is a turn on, if these count.
    positions = stopping(1.5)
    points = door(positions, 0.3)
    points[at : at + 2] = door(positions[at : at + 2] + np.array((2.1, 4.2)), 0.5)
    assert best(JointType.REVOLUTE, points, 0, 0.001).limits == pytest.approx((0.0, 1.5), abs=0.02)


def test_three_samples_teach_nothing() -> None:
    with pytest.raises(MotionError, match=r"track has 3 samples; allowed: 8 positions or more"):
        learn(seen(np.zeros((3, 3))))


@pytest.mark.reference
def test_a_real_track_of_each_object_gets_its_label(reference: Path) -> None:
    objects = {
        "mechanisms_iros_2010/dishwasher/003.log": "revolute",
        "mechanisms_iros_2010/left_door/007.log": "revolute",
        "mechanisms_iros_2010/right_door/005.log": "revolute",
        "mechanisms_iros_2010/drawer/006.log": "prismatic",
        "cabinet_one/006.log": "revolute",
        "drawer_one/009.log": "prismatic",
        "microwave/microwave1.log": "revolute",
    }
    folder = reference / "articulation_tracks"
    found = {name: learn(read_track(folder / name)).best.joint_type.value for name in objects}
    assert found == objects
