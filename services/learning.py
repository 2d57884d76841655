"""Mode 3 put together: a track, a kitchen, what the Law says of it, and Φ′ where Φ does not replay it."""

from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pyoxigraph as ox
from scipy.spatial.transform import Rotation

from predicates.learn import Learned, Track
from predicates.learn.articulation import SURE
from predicates.learn.coupled import coupled
from predicates.learn.explain import Explanation, explain
from predicates.learn.following import Following, follow, following_triples, in_joints, key_of
from predicates.learn.held import held
from predicates.learn.phases import Latch, Plain, PushToOpen, phases
from predicates.learn.proposal import Proposal, propose
from predicates.learn.record import Key, learned_triples, phase_triples, proposal_triples
from predicates.oracle import Physics
from sdt_kg.errors import InputError
from sdt_kg.iri import PREFIXES
from sdt_kg.mechanism import JointType, Pose
from sdt_kg.motion import Motion
from sdt_kg.store import Triple
from sdt_kg.twin import Twin
from services.physics.chain import follower
from services.physics.observe import REACH, Followed, followed, motion_of, near_first
from services.physics.replay import effective_bounds
from services.physics.tree import Model, build
from services.store.output import write_file


@dataclass(frozen=True, slots=True, eq=False)
class Seen:
    """What a track is in a kitchen.

    Attributes:
        followed: The track as motion of one container.
        fits: Whether the twin's own path is as near to the track as its noise allows.
        motion: τ without noise.
        stretch: By what the track's times are stretched to keep to the limits; NaN without times.
        explanation: What the Law says of τ, the task unknown.
    """

    followed: Followed
    fits: bool
    motion: Motion
    stretch: float
    explanation: Explanation

    @property
    def replayed(self) -> bool:
        """Whether Φ replays what was seen: the path is the twin's, and Causes holds of τ."""
        return self.fits and self.explanation.replayed


def placed(track: Track, root_T_track: Pose) -> Track:
    """The track in the kitchen's root frame."""
    matrix, turn = root_T_track.matrix(), Rotation.from_quat(root_T_track.orientation)
    turned = None if track.orientations is None else (turn * Rotation.from_quat(track.orientations)).as_quat()
    return Track(
        track.positions @ matrix[:3, :3].T + matrix[:3, 3],
        track.times,
        track.timed,
        turned,
        None if track.forces is None else track.forces @ matrix[:3, :3].T,
        track.missing,
        track.name,
    )


def seen_in(twin: Twin, learned: Learned, physics: Physics, container: str | None = None) -> Seen:
    """What a track is in a kitchen: as motion of the container given, or of the one that fits best.

    Args:
        twin: In the state in which the track begins.
        learned: From the track, in the kitchen's root frame.
        physics: Φ.
        container: Name or IRI; None looks for it.

    Raises:
        UnknownEntityError: No such container.
        InputError: No handle within reach of where the track begins.
    """
    model, track = build(twin.mechanism(twin.environment)), learned.track
    if container is not None:
        one = followed(model, twin, track, twin.container(container))
        candidates = [] if one is None else [one]
    else:
        candidates = list(near_first(model, twin, track))
    if not candidates:
        begin = ", ".join(f"{value:.2f}" for value in track.positions[0])
        about = f"the handle of {container}" if container else "any handle"
        raise InputError(
            f"the track begins at ({begin}) m, not near {about}",
            allowed=f"within {REACH} m, in the kitchen's root frame and its present state",
            remedy="give the pose of the track's frame with --at, or the state with --state",
        )
    fitting = [each for each in candidates if _fits(model, twin, each, learned)]
    best = min(fitting, key=lambda each: float(np.median(each.distances))) if fitting else candidates[0]
    motion, stretch = motion_of(model, twin, track, best)
    return Seen(best, bool(fitting), motion, stretch, explain(twin, motion, physics))


def _fits(model: Model, twin: Twin, one: Followed, learned: Learned) -> bool:
    bounds = effective_bounds(model, twin, follower(model, one.container.joint))
    return one.explains(learned.best.scale, bounds)


def proposal_for(twin: Twin, learned: Learned, seen: Seen, physics: Physics) -> tuple[Proposal, Seen]:
    """Φ′ for the container, and what the track is in the proposed twin.

    Raises:
        InputError: What was seen stands still, the joint is coupled to others, or what it moves then is
            no container any more.
    """
    moving = [each for each in learned.candidates if each.joint_type is not JointType.FIXED]
    best = learned.best if not moving else moving[0]
    share = learned.probabilities[learned.candidates.index(best)]
    only = f"the joint is {best.joint_type.value}, with the probability {share:.2f} only"
    proposal = propose(twin, seen.followed.container, best, () if share >= SURE else (only,))
    _check_counts(proposal)
    return proposal, seen_in(proposal.twin, learned, physics, seen.followed.container.iri)


def _check_counts(proposal: Proposal) -> None:
    """What the learned joint moves is still a container.

    Raises:
        InputError: It is none; with the reason.
    """
    own = proposal.container
    for each in proposal.twin.left_out():
        if each.body == own.iri:
            raise InputError(
                f"as seen {own.name} is {proposal.after.type.value}, then it is no container: {each.reason}",
                allowed="a joint with which it is still a container",
                remedy="without --kitchen the track says what it is by itself",
            )


@dataclass(frozen=True, slots=True, eq=False)
class SeenTogether:
    """Two tracks in a kitchen whose joints move together, and the twin in which the second follows the first.

    Attributes:
        following: The proposed twin.
        proposals: Joints that the twin did not have right: each is proposed before the coupling.
        first, second: What the tracks are in the proposed twin.
    """

    following: Following
    proposals: tuple[Proposal, ...]
    first: Seen
    second: Seen

    @property
    def replayed(self) -> bool:
        """Whether the proposed twin replays both."""
        return self.first.replayed and self.second.replayed


def together_in(
    twin: Twin, tracks: tuple[Learned, Learned], physics: Physics, names: tuple[str | None, str | None]
) -> SeenTogether:
    """The twin in which the container of the second track follows that of the first.

    A joint that the twin does not have right is learned first, from its own track.

    Args:
        twin: In the state in which both tracks begin.
        tracks: Learned, in the kitchen's root frame.
        physics: Φ.
        names: Of the containers; None looks for them.

    Raises:
        UnknownEntityError: No such container.
        InputError: A track is of no container, or on no path that can be learned; or nothing follows.
    """
    ground, proposals, ones = twin, list[Proposal](), list[Followed]()
    for learned, name in zip(tracks, names, strict=True):
        seen = seen_in(ground, learned, physics, name)
        if not seen.fits:
            proposal, seen = proposal_for(ground, learned, seen, physics)
            ground = proposal.twin
            proposals.append(proposal)
        if not seen.fits:
            raise InputError(
                f"{learned.track.name} is not on the path of {seen.followed.container.name}",
                allowed="tracks of joints that the twin has, or that can be learned",
            )
        ones.append(seen.followed)
    inside = [in_joints(learned, one.values, one.radius) for learned, one in zip(tracks, ones, strict=True)]
    leader, container = (ground.container(one.container.iri) for one in ones)
    made = follow(ground, leader, container, coupled(inside[0], inside[1]))
    first, second = (
        seen_in(made.twin, learned, physics, one.container.iri)
        for learned, one in zip(tracks, ones, strict=True)
    )
    return SeenTogether(made, tuple(proposals), first, second)


def together_triples(
    twin: Twin, tracks: tuple[Learned, Learned], found: SeenTogether
) -> tuple[Key, list[Triple]]:
    """Φ′ of the coupling in RDF, of each joint that was learned before it, and of what held either."""
    triples = list(following_triples(twin, tracks, found.following))
    proposed = {each.container.iri: each for each in found.proposals}
    for learned, seen in zip(tracks, (found.first, found.second), strict=True):
        proposal, phase = proposed.get(seen.followed.container.iri), held_by(learned)
        if proposal is not None or isinstance(phase, Latch | PushToOpen):
            triples += branch_triples(twin, learned, seen, proposal)[1]
    return key_of(twin, tracks, found.following), triples


def together_held(tracks: tuple[Learned, Learned], found: SeenTogether) -> Twin:
    """The twin in which the second follows the first, and each joint says what was seen to hold it."""
    first = with_held(found.following.twin, found.first, tracks[0])
    return with_held(first, found.second, tracks[1])


def held_by(learned: Learned) -> Latch | PushToOpen | Plain | None:
    """What held the container before it moved; None where no force was observed, or nothing moved."""
    if learned.track.forces is None or learned.best.joint_type is JointType.FIXED:
        return None
    return phases(learned.track, learned.best)


def with_held(twin: Twin, seen: Seen, learned: Learned) -> Twin:
    """The twin whose joint says what was seen to hold the container, if anything but friction did."""
    phase = held_by(learned)
    if phase is None or isinstance(phase, Plain):
        return twin
    return held(twin, twin.container(seen.followed.container.iri), phase)


def branch_triples(
    twin: Twin, learned: Learned, seen: Seen, proposal: Proposal | None
) -> tuple[Key, list[Triple]]:
    """Φ′ in RDF: the learned joint, what it changes, and what held the container."""
    container, joint = seen.followed.container, learned.best if proposal is None else proposal.learned
    key = Key.of(twin, container, learned.track)
    triples = list(learned_triples(twin, container, learned.track, joint))
    if proposal is not None:
        triples += proposal_triples(key.iri, proposal)
    phase = held_by(learned)
    if phase is not None:
        triples += phase_triples(key.iri, phase)
    return key, triples


def write_branch(path: Path, twin: Twin, key: Key, triples: list[Triple]) -> None:
    """A twin is in a TriG file, Φ′ and what it rests on in a named graph of its own.

    Raises:
        InputError: The file is no .trig, or cannot be written.
    """
    if path.suffix != ".trig":
        raise InputError(f"'{path.name}' is no .trig file", allowed="BRANCH.trig")
    store, graph = ox.Store(), ox.NamedNode(key.graph)
    store.load(twin.serialize("nquads"), format=ox.RdfFormat.N_QUADS)
    store.extend(
        ox.Quad(ox.NamedNode(subject), ox.NamedNode(predicate), value, graph)
        for subject, predicate, value in triples
    )
    dumped = store.dump(format=ox.RdfFormat.TRIG, prefixes=PREFIXES)
    assert dumped is not None, "pyoxigraph writes to memory where no file is named"
    write_file(path, dumped)
