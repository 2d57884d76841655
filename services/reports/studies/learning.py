"""What an observed track says of a joint, and what the twin would have to say."""

from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from predicates.learn import Learned, Track, learn
from predicates.learn.proposal import Proposal
from sdt_kg.errors import InputError
from sdt_kg.mechanism import Joint, JointType, Pose
from sdt_kg.twin import Container, Twin
from services.app import Service, load
from services.learning import Seen, placed, proposal_for, seen_in
from services.physics.chain import chain
from services.physics.tree import build
from services.reports.pages.figure import Figure, drawn
from services.reports.pages.table import Cell, Table
from services.reports.scene.camera import framed
from services.reports.scene.clip import Line, container_clip
from services.reports.scene.colors import COLORS
from services.reports.scene.view import View, view_of
from services.requests import listed_states, parse_base
from services.tracks import read_track

Array = NDArray[np.float64]

SAMPLES, SECONDS = 60, 4.0
"""Of a track that is made here: [1], [s]."""

STRAIGHT = 1e-9
"""[m] Second differences of a slide's path are rounding."""

FINE = 64
"""[1] Points of a path that is drawn."""


@dataclass(frozen=True, slots=True, eq=False)
class Lesson:
    """A track, what it says, and what it is in a kitchen.

    Attributes:
        origin: Where the track comes from, in words.
        service: The kitchen; the track is in its root frame.
        proposal: Φ′ and what the track is in it; None where the twin has the path already.
    """

    origin: str
    service: Service
    learned: Learned
    seen: Seen
    proposal: tuple[Proposal, Seen] | None


def lesson(  # noqa: PLR0913 - the options of sdt learn
    kitchen: str,
    track: str = "",
    *,
    container: str = "",
    at: str = "",
    state: str = "",
    shift: float = 0.0,
    noise: float = 0.002,
    seed: int = 0,
) -> Lesson:
    """What a track says, and what it is in a kitchen.

    Args:
        kitchen: Bundled name or path.
        track: File of an observed track. Without one, a track is made here: of the container's handle, with
            its joint elsewhere by `shift` and with noise.
        container: Whose motion it is; empty: the one that fits best (with a file only).
        at: Where the track's frame stands in the kitchen: X,Y,YAW.
        state: Joints elsewhere, comma-separated.
        shift: By how much the joint that is observed is elsewhere [m].
        noise: Standard deviation of a made track, in each direction [m].
        seed: Of the noise.

    Raises:
        InputError: Something of these does not exist.
        MotionError: The track says nothing.
    """
    service = load(kitchen, state=listed_states(state))
    twin = service.twin
    if track:
        observed, origin = read_track(Path(track)), Path(track).name
    else:
        if not container:
            raise InputError(
                "neither a track nor a container", allowed="track=FILE, or container=NAME to make one"
            )
        if noise < 0:
            raise InputError(f"noise={noise}", allowed="0 or more, in m")
        observed = made(twin, twin.container(container), shift, noise, seed)
        moved = f"its joint {1000 * shift:.0f} mm elsewhere, noise {1000 * noise:.1f} mm"
        origin = f"made here: {container} with {moved}"
    pose = parse_base(at or None)
    if pose is not None:
        turn = (0.0, 0.0, float(np.sin(pose[2] / 2)), float(np.cos(pose[2] / 2)))
        observed = placed(observed, Pose((pose[0], pose[1], 0.0), turn))
    learned = learn(observed)
    seen = seen_in(twin, learned, service.physics, container or None)
    proposal = None if seen.fits else proposal_for(twin, learned, seen, service.physics)
    return Lesson(origin, service, learned, seen, proposal)


def made(twin: Twin, container: Container, shift: float, noise: float, seed: int) -> Track:
    """A track of a handle whose joint is elsewhere, with noise.

    Args:
        twin: Kitchen and state.
        container: Goes from one limit to the other.
        shift: A hinge is farther from the handle by so much [m]; a slide goes aside by so much a metre.
        noise: Standard deviation in each direction [m].
        seed: Of the noise.
    """
    path = chain(build(twin.mechanism(twin.environment)), container.handle, twin.state)
    own = np.linspace(container.lower, container.upper, SAMPLES)
    frames = path.poses((own - container.offset) / container.multiplier)[0]
    positions, turns = frames[:, :3, 3], frames[:, :3, :3] @ frames[0, :3, :3].T
    first, bend = positions[1] - positions[0], positions[2] - 2 * positions[1] + positions[0]
    if np.linalg.norm(bend) > STRAIGHT:  # about a hinge, p = c + R (p0 - c)
        inward = bend / np.linalg.norm(bend)
        positions = positions + shift * (inward - turns @ inward)
    else:
        aside = np.cross((0.0, 0.0, 1.0), first / np.linalg.norm(first))
        positions = positions + shift * (own - own[0])[:, None] * aside
    positions = positions + np.random.default_rng(seed).normal(0.0, noise, positions.shape)
    return Track(positions, np.linspace(0.0, SECONDS, SAMPLES), timed=True, name="made track")


def candidates(found: Lesson) -> Table:
    """Each joint type with its evidence."""
    rows = [
        {
            "joint": Cell(each.joint_type.value, "certified" if each is found.learned.best else ""),
            "probability": probability,
            "log evidence": each.evidence,
            "deviation, all samples [mm]": 1000 * each.residual_rms,
            "scale [mm]": 1000 * each.scale,
            "outliers": each.outliers,
            "radius [m]": each.radius if each.joint_type is JointType.REVOLUTE else None,
            "± [mm]": 1000 * each.deviations["radius"] if each.joint_type is JointType.REVOLUTE else None,
        }
        for each, probability in zip(found.learned.candidates, found.learned.probabilities, strict=True)
    ]
    samples = f"{len(found.learned.track.positions)} samples, {found.learned.track.missing} missing"
    return Table.of(
        "learning_candidates", f"Which joint moves what was seen. Track: {found.origin}; {samples}.", rows
    )


def in_kitchen(found: Lesson) -> Table:
    """What the track is in the kitchen, and in the proposed one."""
    rows = [_row("the twin as it is", found.seen)]
    if found.proposal is not None:
        rows.append(_row("the proposed twin", found.proposal[1]))
    return Table.of(
        "learning_kitchen",
        "Whether the physics of each twin replays what was seen, and which task it is.",
        rows,
    )


def _row(which: str, seen: Seen) -> dict[str, object]:
    tasks = [str(each) for each in seen.explanation.tasks] if seen.fits else []
    return {
        "twin": which,
        "container": seen.followed.container.name,
        "median distance from its path, limits aside [mm]": 1000 * float(np.median(seen.followed.distances)),
        "its path fits": seen.fits,
        "replayed": seen.replayed,
        "tasks": ", ".join(tasks) or "none",
    }


def proposed(found: Lesson) -> Table:
    """The joint as it is and as it would have to be; no row where the twin has the path already."""
    if found.proposal is None:
        rows = [{"joint": "unchanged", "what": "the twin has the path already"}]
        return Table.of("learning_proposal", "Nothing is proposed.", rows)
    proposal, _ = found.proposal
    rows = [_joint_row("as it is", proposal.before), _joint_row("proposed", proposal.after)]
    assumed = "; ".join(proposal.assumptions)
    return Table.of(
        "learning_proposal",
        f"What the twin would have to say of {proposal.before.name}. Assumed: {assumed}.",
        rows,
    )


def _joint_row(which: str, joint: Joint) -> dict[str, object]:
    return {
        "the joint": which,
        "type": joint.type.value,
        "origin [m]": _vector(joint.origin.position),
        "axis": _vector(joint.axis),
        "lower": joint.limits.lower,
        "upper": joint.limits.upper,
    }


def _vector(values: tuple[float, float, float]) -> str:
    return ", ".join(f"{value:.3f}" for value in values)


def track_figure(found: Lesson) -> Figure:
    """What was seen, what was learned and what the twin has; and how far the samples are from each."""
    twin, learned = _paths(found)
    points = found.learned.track.positions
    with drawn(2.5) as drawing:
        above, side, deviations = drawing.subplots(1, 3)
        for axes, (i, j), names in ((above, (0, 1), "xy"), (side, (0, 2), "xz")):
            axes.plot(points[:, i], points[:, j], ".", color=COLORS["seen"], markersize=3, label="seen")
            axes.plot(learned[:, i], learned[:, j], color=COLORS["learned"], label="learned")
            axes.plot(twin[:, i], twin[:, j], "--", color=COLORS["path"], label="twin")
            axes.set_aspect("equal", adjustable="datalim")
            axes.set(xlabel=f"{names[0]} [m]", ylabel=f"{names[1]} [m]")
        above.set_title("from above")
        side.set_title("from the side")
        above.legend(fontsize=6.5)
        samples = np.arange(len(points))
        deviations.plot(
            samples, 1000 * found.learned.best.distances, color=COLORS["learned"], label="learned"
        )
        deviations.plot(
            samples, 1000 * found.seen.followed.distances, "--", color=COLORS["path"], label="twin"
        )
        deviations.set(xlabel="sample", ylabel="mm", title="distance from the path")
        deviations.set_ylim(bottom=0)
    caption = (
        "The track, the joint that explains it best, and the path of the same point in the twin, where the"
        " track is beyond the joint's limits too."
    )
    return Figure("learning_track", caption, drawing)


def _paths(found: Lesson) -> tuple[Array, Array]:
    """The observed point along the twin's path and along the learned one, shape (FINE, 3) each [m]."""
    best, followed = found.learned.best, found.seen.followed
    twin = found.service.twin
    path = chain(build(twin.mechanism(twin.environment)), followed.container.handle, twin.state)
    low, high = float(followed.values.min()), float(followed.values.max())
    own = np.linspace(low, high, FINE)
    multiplier, offset = path.follower.multiplier, path.follower.offset
    frames = path.poses((own - offset) / multiplier)[0]
    return frames[:, :3, :3] @ followed.offset + frames[:, :3, 3], best.point(np.linspace(*best.limits, FINE))


def view(found: Lesson) -> View:
    """The kitchen with what was seen and learned, the container moving as the proposed twin has it."""
    twin, seen = found.service.twin, found.seen
    if found.proposal is not None:
        twin, seen = found.proposal[0].twin, found.proposal[1]
    clip = container_clip(
        f"{seen.followed.container.name}, as {'proposed' if found.proposal else 'the twin has it'}",
        build(twin.mechanism(twin.environment)),
        twin,
        seen.motion,
        "The container's motion without noise, in the twin that replays it."
        if seen.replayed
        else "Not replayed.",
    )
    own, learned = _paths(found)
    lines = (
        Line(found.learned.track.positions, "seen", "seen"),
        Line(learned, "learned", "learned"),
        Line(own, "the twin's own", "gap"),
    )
    points = np.vstack([each.points for each in lines])
    start = twin.kitchen().start
    towards = np.array(start[:2]) - points.mean(axis=0)[:2]
    around = np.vstack((points + 0.4, points - 0.4))
    camera = framed(around, float(np.arctan2(towards[1], towards[0])))
    title = "What was seen (green), what was learned of it (blue), and where the twin would have it (violet)."
    return view_of(twin, [], title, [replace(clip, lines=lines, camera=camera)])
