"""Whether what an oracle answered is an answer to what was asked: no other is taken for one."""

import numpy as np

from predicates.case import Answer, ArtefactKind, Case
from predicates.meant import moved_by
from sdt_kg.errors import InputError, SdtError
from sdt_kg.motion import BodyMotion, Motion, check_body_motion
from sdt_kg.task import Unknown
from services.bus.oracles.codec import Plain, answer_value
from services.embodiment.certify.certificate import Certificate, models_of, read_certificate

ARRAYS = ("times", "base", "base_v", "q", "v", "kitchen_q", "kitchen_v")


class UnfitReplyError(SdtError):
    """What an oracle replied is no answer to what it was asked: nothing follows from it."""


def answer_to(asked: Case, plain: Plain) -> Answer:
    """What an oracle answered to whether CanPerform holds of a case.

    Raises:
        InputError: That is no answer.
        UnfitReplyError: It is an answer to something else.
    """
    answer = answer_value(asked.twin, plain)
    check_answer(asked, answer)
    return answer


def check_answer(asked: Case, answer: Answer) -> None:
    """CanPerform was answered about this case; where it holds, with a certificate of this very motion.

    What certified it is not run again: that is the oracle's, of the version that the verdict names.

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
    if not answer.holds:
        return
    motion = case.body_motion
    if not isinstance(motion, BodyMotion) or motion.robot != asked.robot:
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
    _check_certificate(asked, answer, motion, certificate)


def _check_certificate(asked: Case, answer: Answer, motion: BodyMotion, certificate: Certificate) -> None:
    """The certificate is about these models, this state, container and motion, and says the same."""
    assert isinstance(asked.robot, str), "it is the robot of the motion"
    if certificate.models != models_of(asked.twin, asked.robot):
        raise UnfitReplyError("its certificate is about other models")
    if certificate.state != dict(asked.twin.state):
        raise UnfitReplyError("its certificate is about another state")
    moved: Motion | Unknown = asked.motion
    if isinstance(moved, Motion) and certificate.container not in {
        each.iri for each in moved_by(asked.twin, moved.of)
    }:
        raise UnfitReplyError("its certificate is about another container")
    if not _are_same(motion, certificate.motion):
        raise UnfitReplyError("its certificate is about another body motion")
    if any(answer.figures.get(name) != said for name, said in certificate.figures.items()):
        raise UnfitReplyError("its certificate says other figures")


def _are_same(one: BodyMotion, other: BodyMotion) -> bool:
    """Whether two body motions are the same, to the last bit."""
    return (one.robot, one.gripper, one.joints) == (other.robot, other.gripper, other.joints) and all(
        np.array_equal(getattr(one, name), getattr(other, name)) for name in ARRAYS
    )
