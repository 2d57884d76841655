"""Whether what an oracle answered is an answer to what was asked: no other is taken for one."""

from dataclasses import replace

import numpy as np

from predicates.case import Answer, Artefact, ArtefactKind, Case
from predicates.meant import containers_meant, coupled, moved_by
from predicates.oracle import Embodiment, Replayed
from sdt_kg.errors import InputError, SdtError
from sdt_kg.iri import Iri
from sdt_kg.motion import BodyMotion, Motion, check_body_motion
from sdt_kg.twin import Twin
from services.bus.oracles.agrees import SAME, Demand
from services.bus.oracles.codec import Plain, answer_value, replayed_value
from services.embodiment.certify.certificate import Certificate, models_of, read_certificate
from services.embodiment.proof_check import check
from services.embodiment.proof_check.proof.written import read_proof
from services.embodiment.recheck.claim import figures_differ
from services.policy import Policy

ARRAYS = ("times", "base", "base_v", "q", "v", "kitchen_q", "kitchen_v")


class UnfitReplyError(SdtError):
    """What an oracle replied is no answer to what it was asked: nothing follows from it."""


def answer_to(asked: Case, policy: Policy, here: Embodiment, plain: Plain) -> Answer:
    """What an oracle answered to whether CanPerform holds of a case, under a policy.

    Between which bodies its smallest distances are is what was found here.

    Args:
        asked: The case.
        policy: Under which it was asked.
        here: R of this process, under the same policy: what it holds of is certified here too.
        plain: What the bus carried.

    Raises:
        InputError: That is no answer.
        UnfitReplyError: It is an answer to something else, or does not hold here.
    """
    answer = answer_value(asked.twin, plain)
    check_answer(asked, policy, answer)
    return _found_again(asked, answer, here) if answer.holds else answer


def replayed_of(twin: Twin, motion: Motion, plain: Plain) -> Replayed:
    """What Φ on the bus made of a motion.

    Raises:
        InputError: That is nothing that Φ says.
        UnfitReplyError: It is about another motion or kitchen.
    """
    replayed = replayed_value(plain)
    if set(replayed.final) != set(twin.state):
        raise UnfitReplyError("its final state is not one of this kitchen")
    if not np.isfinite([position for _, position in replayed.final.items()]).all():
        raise UnfitReplyError("in its final state a position is not a number")
    if moved_by(twin, replayed.motion.of) != moved_by(twin, motion.of):
        raise UnfitReplyError("it is about a motion of something else")
    return replayed


def check_replayed(told: Replayed, here: Replayed) -> None:
    """What Φ on the bus says is what Φ of the same version makes of the motion in this process.

    Raises:
        UnfitReplyError: It is not.
    """
    final = {joint: abs(told.final[joint] - at) for joint, at in here.final.items()}
    if max(final.values()) > SAME:
        raise UnfitReplyError("its final state is another than the one that this version finds")
    if not _are_near(told.motion, here.motion):
        raise UnfitReplyError("its motion is another than the one that this version reads")
    if [(each.kind, each.proof) for each in told.violations] != [
        (each.kind, each.proof) for each in here.violations
    ]:
        raise UnfitReplyError("it finds other violations than this version does")
    for each in figures_differ(told.figures, here.figures, "the reply", "what this version finds"):
        raise UnfitReplyError(each)


def _are_near(one: Motion, other: Motion) -> bool:
    """Whether two motions are of one joint and differ by rounding."""
    arrays, others = (
        [each.times, each.values, *([] if each.velocities is None else [each.velocities])]
        for each in (one, other)
    )
    return (one.of, one.timed, len(arrays)) == (other.of, other.timed, len(others)) and all(
        here.shape == there.shape and np.allclose(here, there, rtol=0, atol=SAME)
        for here, there in zip(arrays, others, strict=True)
    )


def check_answer(asked: Case, policy: Policy, answer: Answer) -> None:
    """CanPerform was answered about this case; where it holds, with a certificate of this very motion.

    What is *proved* is verified here.

    Raises:
        UnfitReplyError: It was not.
    """
    case = answer.case
    if (case.robot, case.task) != (asked.robot, asked.task):
        raise UnfitReplyError("it is about another robot or task")
    if answer.holds == bool(answer.diagnoses):
        raise UnfitReplyError(
            "it holds, with reasons why not" if answer.holds else "it gives no reason why not"
        )
    assert isinstance(asked.robot, str), "it is the robot that was asked about"
    demand = Demand(asked, asked.robot, policy)
    if answer.holds:
        _check_performed(demand, answer)
    elif any(each.proof for each in answer.diagnoses):
        _check_proof(demand, answer.artefact)


def _check_performed(demand: Demand, answer: Answer) -> None:
    """It holds of a body motion, which is the given one if one was, with a certificate of it."""
    asked, robot, motion = demand.asked, demand.robot, answer.case.body_motion
    if not isinstance(motion, BodyMotion) or motion.robot != robot:
        raise UnfitReplyError("it holds, and has no body motion of the robot")
    if isinstance(asked.body_motion, BodyMotion) and not _are_same(motion, asked.body_motion):
        raise UnfitReplyError("it is about another body motion than the given one")
    if answer.artefact is None or answer.artefact.kind is not ArtefactKind.CERTIFICATE:
        raise UnfitReplyError("it holds, and has no certificate")
    try:
        check_body_motion(motion)
        certificate = read_certificate(answer.artefact.content)
    except InputError as error:
        raise UnfitReplyError(f"its body motion or certificate: {error}") from None
    _check_certificate(asked, robot, answer, certificate)
    if certificate.drive is not demand.drive:
        raise UnfitReplyError(f"its certificate is about a base that is {certificate.drive.value}")
    if not _are_same(motion, certificate.motion):
        raise UnfitReplyError("its certificate is about another body motion")


def _found_again(asked: Case, answer: Answer, here: Embodiment) -> Answer:
    """The answer, whose body motion is certified in this process, and each figure of it found again."""
    again = here.perform(replace(asked, body_motion=answer.case.body_motion))
    if not again.holds:
        reasons = "; ".join(each.reason for each in again.diagnoses)
        raise UnfitReplyError(f"its body motion is not certified here: {reasons}")
    found = {name: figure for name, figure in again.figures.items() if name in answer.figures}
    for each in figures_differ(answer.figures, found, "the reply", "the certificate made here"):
        raise UnfitReplyError(each)
    theirs, ours = (read_certificate(each.artefact.content) for each in (answer, again) if each.artefact)
    if theirs.tolerances != ours.tolerances:
        raise UnfitReplyError("its certificate is about other tolerances")
    start, own = theirs.start, ours.start
    if not (start == own or (start and own and np.allclose(start, own, rtol=0, atol=SAME))):
        raise UnfitReplyError("its certificate is about another start")
    return replace(answer, nearest_pairs=again.nearest_pairs)


def _check_proof(demand: Demand, artefact: Artefact | None) -> None:
    """It is a proof, about this case and base policy, that holds and leaves nothing out."""
    asked = demand.asked
    if artefact is None or artefact.kind is not ArtefactKind.PROOF:
        raise UnfitReplyError("it says that something is proved, and has no proof")
    try:
        proof = read_proof(artefact.content)
        claim = proof.claim
        if claim.partial:
            raise UnfitReplyError("it says that something is proved, and its proof leaves some holds out")
        if claim.container not in _containers(asked):
            raise UnfitReplyError("its proof is about another container")
        for other in demand.of_proof(proof):
            raise UnfitReplyError(f"its proof is about {other}")
        checked = check(asked.twin, demand.robot, asked.twin.container(claim.container), artefact.content)
    except InputError as error:
        raise UnfitReplyError(f"its proof: {error}") from None
    if not checked.holds:
        raise UnfitReplyError(f"its proof does not hold: {'; '.join(checked.reasons)}")


def _containers(asked: Case) -> set[Iri]:
    """Those that the case may be about, and those that move with them: their handles will do."""
    meant = containers_meant(asked)
    return {each.iri for one in meant for each in (one, *coupled(asked.twin, one))}


def _check_certificate(asked: Case, robot: Iri, answer: Answer, certificate: Certificate) -> None:
    """The certificate is about these models, this state and container, and says the same."""
    if certificate.models != models_of(asked.twin, robot):
        raise UnfitReplyError("its certificate is about other models")
    if certificate.state != dict(asked.twin.state):
        raise UnfitReplyError("its certificate is about another state")
    if certificate.container not in _containers(asked):
        raise UnfitReplyError("its certificate is about another container")
    if any(answer.figures.get(name) != said for name, said in certificate.figures.items()):
        raise UnfitReplyError("its certificate says other figures")


def _are_same(one: BodyMotion, other: BodyMotion) -> bool:
    """Whether two body motions are the same, to the last bit."""
    return (one.robot, one.gripper, one.joints) == (other.robot, other.gripper, other.joints) and all(
        np.array_equal(getattr(one, name), getattr(other, name)) for name in ARRAYS
    )
