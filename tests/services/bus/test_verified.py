"""What an oracle on the bus replies is taken for an answer only if it is right, and to what was asked."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest

from predicates.can_perform import can_perform
from predicates.case import Answer, Case
from predicates.margins import SMALLEST, is_bound
from sdt_kg.annotation import Drive
from sdt_kg.errors import InputError
from sdt_kg.motion import Array, Motion
from sdt_kg.state import State
from services.app import Policy, Service, load, whole_body
from services.bus.keys import Oracle
from services.bus.oracles.bound import UnfitReplyError, answer_to, check_replayed, replayed_of
from services.bus.oracles.codec import Plain, replayed_plain, replayed_value
from services.bus.oracles.remote import BusOracles
from services.bus.oracles.server import oracle
from services.bus.sessions import open_session
from services.embodiment.certify.certificate import Figures, read_certificate
from services.embodiment.certify.tolerances import Tolerances
from services.embodiment.proof_check.proof.content import LEAF
from services.embodiment.proof_check.proof.written import read_proof, to_bytes
from services.embodiment.prove import Prover
from services.judging.codec import to_cbor
from services.judging.problems import BusUnavailableError
from tests.ports import free_endpoint
from tests.services.bus.replies import DRAWER, FIXED, FREE, NAN, OTHER, Change, case_of, replying, sent


@pytest.fixture(scope="module")
def foreign(here: Service) -> Plain:
    """The right answer about another drawer."""
    (answer,) = can_perform(case_of(here, OTHER), here.embodiment)
    assert answer.holds
    return sent(answer)


def test_the_right_answer_is_one_and_that_to_another_question_is_none(
    here: Service, asked: tuple[Case, Plain], foreign: Plain
) -> None:
    case, plain = asked
    assert answer_to(case, FREE, here.embodiment, plain).holds
    for other in (foreign, plain | {"artefact": foreign["artefact"]}, plain | {"case": foreign["case"]}):
        with pytest.raises(UnfitReplyError):
            answer_to(case, FREE, here.embodiment, other)
    container = here.twin.container(DRAWER)
    for twin in (
        here.twin.at({container.joint: 0.05}),
        here.twin.with_edit(container.joint, upperLimit=0.47),
    ):
        with pytest.raises(UnfitReplyError, match="its certificate is about"):
            answer_to(replace(case, twin=twin), FREE, here.embodiment, plain)


def test_a_certificate_under_another_base_policy_is_no_answer(
    here: Service, asked: tuple[Case, Plain]
) -> None:
    with pytest.raises(UnfitReplyError, match="a base that is omni"):
        answer_to(asked[0], FIXED, here.embodiment, asked[1])


def forged(
    plain: Plain, figures: Figures | None = None, parts: Plain | None = None, **arrays: Array
) -> Plain:
    """The same answer about another body motion, with other figures or parts, as its certificate says too."""
    kind, content = plain["artefact"]
    one = replace(read_certificate(content), **(parts or {}))
    other = replace(one, motion=replace(one.motion, **arrays), figures=one.figures | (figures or {}))
    said = {name: list(value) for name, value in other.figures.items()}
    moved = plain["case"]["body_motion"] | arrays
    about = {"case": plain["case"] | {"body_motion": moved}, "figures": plain["figures"] | said}
    return plain | about | {"artefact": [kind, other.content()]}


def test_what_is_found_elsewhere_is_certified_here_once_more(
    here: Service, asked: tuple[Case, Plain]
) -> None:
    case, plain = asked
    q = read_certificate(plain["artefact"][1]).motion.q
    found = answer_to(case, FREE, here.embodiment, forged(plain))
    assert found.holds
    own = {n for n, (at, _) in found.figures.items() if n.startswith(SMALLEST) and not is_bound(at)}
    assert found.nearest_pairs.keys() == own
    aside, hasty = q.copy(), np.array(plain["case"]["body_motion"]["times"]) / 2
    aside[len(q) // 2 :, 0] += 0.1
    with pytest.raises(UnfitReplyError, match="not certified here"):
        answer_to(case, FREE, here.embodiment, forged(plain, q=aside))
    with pytest.raises(UnfitReplyError, match="velocity"):
        answer_to(case, FREE, here.embodiment, forged(plain, times=hasty))
    far = {"smallest distance, environment": (0.5, "m")}
    with pytest.raises(UnfitReplyError, match=r"environment' is 0\.5 m in the reply"):
        answer_to(case, FREE, here.embodiment, forged(plain, far))
    for parts in ({"start": None}, {"tolerances": Tolerances(contact=0.001)}):
        with pytest.raises(UnfitReplyError, match=r"another start|other tolerances"):
            answer_to(case, FREE, here.embodiment, forged(plain, parts=parts))


def test_what_has_its_times_is_certified_with_them(here: Service, asked: tuple[Case, Plain]) -> None:
    case, plain = asked
    motion = case.motion
    assert isinstance(motion, Motion)
    timed = replace(case, motion=replace(motion, timed=True))
    with pytest.raises(UnfitReplyError, match="not certified here"):
        answer_to(timed, FREE, here.embodiment, plain)


def test_a_motion_that_is_given_is_certified_here_as_it_was_there(
    here: Service, asked: tuple[Case, Plain]
) -> None:
    case, plain = asked
    found = answer_to(case, FREE, here.embodiment, plain).case
    (given,) = can_perform(found, here.embodiment)
    assert given.holds
    assert answer_to(found, FREE, here.embodiment, sent(given)).holds


@pytest.fixture(scope="module")
def refuted() -> tuple[Service, Case, Plain]:
    """A case of which it is proved that it cannot be, and what an oracle rightly answers."""
    there = load("b", ["stretch"], policy=FIXED)
    case = case_of(there, "iai_fridge_door")
    (answer,) = can_perform(case, there.embodiment)
    assert any(each.proof for each in answer.diagnoses)
    return there, case, sent(answer)


def test_what_is_proved_is_verified(refuted: tuple[Service, Case, Plain], asked: tuple[Case, Plain]) -> None:
    there, case, plain = refuted
    assert any(each.proof for each in answer_to(case, FIXED, there.embodiment, plain).diagnoses)
    kind, content = plain["artefact"]
    proof = read_proof(content)
    first = replace(proof.refutations[0], tree=bytes([LEAF]))  # the whole box, at once
    changed = {
        "has no proof": None,
        "cannot be read": (kind, content[:-9]),
        "has no proof$": asked[1]["artefact"],
        "can come": (kind, to_bytes(replace(proof, refutations=(first, *proof.refutations[1:])))),
        "leaves some holds out": (kind, to_bytes(replace(proof, claim=replace(proof.claim, declared=True)))),
        "another container": (
            kind,
            to_bytes(
                replace(proof, claim=replace(proof.claim, container=asked[0].twin.container(DRAWER).iri))
            ),
        ),
    }
    for said, artefact in changed.items():
        with pytest.raises((InputError, UnfitReplyError), match=said):
            answer_to(case, FIXED, there.embodiment, plain | {"artefact": artefact})
    with pytest.raises(UnfitReplyError, match="its proof is about a base that is fixed"):
        answer_to(case, FREE, there.embodiment, plain)


def test_a_proof_or_certificate_about_another_start_is_no_answer(
    refuted: tuple[Service, Case, Plain], asked: tuple[Case, Plain]
) -> None:
    for (case, plain), policy in ((refuted[1:], FIXED), (asked, FREE)):
        base, contact = replace(policy, base=(0.1, 0.0, -0.5)), replace(policy, contact=0.001)
        with pytest.raises(UnfitReplyError, match=r"is about another start|not certified here: .* starts"):
            answer_to(case, base, whole_body(base), plain)
        with pytest.raises(UnfitReplyError, match=r"is about other tolerances|in the certificate made here"):
            answer_to(case, contact, whole_body(contact), plain)


def test_a_proof_about_more_than_the_way_that_is_asked_about_is_no_answer(
    refuted: tuple[Service, Case, Plain],
) -> None:
    there, case, plain = refuted
    motion = case.motion
    assert isinstance(motion, Motion)
    with pytest.raises(UnfitReplyError, match="is about values that need not be passed"):
        answer_to(
            replace(case, motion=replace(motion, values=motion.values / 2)), FIXED, there.embodiment, plain
        )


def test_a_proof_about_times_is_an_answer_to_these_times_alone(here: Service) -> None:
    case = case_of(here, DRAWER)
    assert isinstance(case.motion, Motion)
    motion = replace(
        case.motion, times=np.linspace(0.0, 1e-3, len(case.motion.times)), velocities=None, timed=True
    )
    about = here.twin, here.twin.robots[0], here.twin.container(DRAWER), Drive.OMNI, (0.0, 0.0, 0.0)
    proved = Prover(*about, motion.values[:, 0]).hurried(motion)
    assert proved is not None
    refusal = Answer(replace(case, motion=motion), False, (proved.diagnosis,), artefact=proved.artefact)
    assert not answer_to(refusal.case, FREE, here.embodiment, sent(refusal)).holds
    slower = replace(motion, times=motion.times * 1e6)
    for other in (slower, replace(motion, timed=False)):
        about_other = replace(case, motion=other)
        with pytest.raises(UnfitReplyError, match="is about times that are not asked for"):
            answer_to(about_other, FREE, here.embodiment, sent(replace(refusal, case=about_other)))


def ending(change: Callable[[Plain], object]) -> Change:
    """With another final state."""
    return lambda plain: plain | {"final": change(plain["final"])}


@pytest.mark.parametrize(
    "change",
    [
        ending(lambda final: dict.fromkeys(final, NAN)),
        ending(lambda final: {joint: at for joint, at in final.items() if "left_middle" not in joint}),
        ending(lambda final: final | {"https://example.org/id/b/joint/other": 0.0}),
        lambda plain: plain | {"motion": plain["motion"] | {"of": "https://example.org/id/b/joint/other"}},
        lambda plain: (
            plain | {"motion": plain["motion"] | {"of": plain["motion"]["of"].replace("left", "right")}}
        ),
    ],
)
def test_what_physics_says_of_something_else_is_an_error(here: Service, change: Change) -> None:
    motion = case_of(here, DRAWER).motion
    assert isinstance(motion, Motion)
    plain = replayed_plain(here.physics.replay(here.twin, motion))
    assert replayed_of(here.twin, motion, plain).final == replayed_value(plain).final
    with pytest.raises((InputError, UnfitReplyError)):
        replayed_of(here.twin, motion, change(plain))  # pyright: ignore[reportArgumentType]  # that is the point


def test_what_physics_says_is_what_this_version_finds(here: Service) -> None:
    motion = case_of(here, DRAWER).motion
    assert isinstance(motion, Motion)
    found, joint = here.physics.replay(here.twin, motion), here.twin.container(DRAWER).joint
    far = replace(motion, values=motion.values * 1.5)
    refused = here.physics.replay(here.twin, far)
    assert refused.violations
    check_replayed(found, here.physics.replay(here.twin, motion))
    check_replayed(refused, here.physics.replay(here.twin, far))
    for told, right, said in (
        (replace(found, final=State.of({**dict(found.final), joint: 0.3})), found, "another than the one"),
        (replace(found, motion=replace(motion, values=motion.values * 0.9)), found, "its motion is another"),
        (replace(found, figures={"force": (1.0, "N")}), found, "the figure 'force'"),
        (replace(refused, violations=()), refused, "other violations"),
        (
            replace(refused, violations=tuple(replace(one, proof=False) for one in refused.violations)),
            refused,
            "other violations",
        ),
    ):
        with pytest.raises(UnfitReplyError, match=said):
            check_replayed(told, right)


@pytest.mark.oracle
def test_an_oracle_that_says_the_drawer_is_open_is_not_believed(here: Service) -> None:
    motion = case_of(here, DRAWER).motion
    assert isinstance(motion, Motion)
    short = replace(motion, values=motion.values * 0.5)
    half = replayed_plain(here.physics.replay(here.twin, short))
    joint = here.twin.container(DRAWER).joint
    said = {"version": here.physics.version, "replay": half | {"final": half["final"] | {joint: 0.48}}}
    with (
        open_session(listen=free_endpoint()) as session,
        replying(session, Oracle.CAUSES, lambda verb: to_cbor(said[verb])),
    ):
        there = BusOracles.on(session).physics()
        with pytest.raises(BusUnavailableError, match="final state is another than the one"):
            there.replay(here.twin, short)
        said |= {"version": "a physics of one's own"}
        other = BusOracles.on(session).physics()
        assert other.replay(here.twin, short).final[joint] == 0.48


@pytest.mark.oracle
def test_settings_are_those_that_this_version_has_under_the_same_policy(here: Service) -> None:
    robot, policy = here.twin.robots[0], Policy(budget=60.0)
    own = here.embodiment.settings(here.twin, robot)
    said = {"version": here.embodiment.version, "settings": [["drive", "fixed"], *map(list, own[1:])]}
    with (
        open_session(listen=free_endpoint()) as session,
        replying(session, Oracle.CANPERFORM, lambda verb: to_cbor(said[verb])),
    ):
        there = BusOracles.on(session).embodiment(policy)
        with pytest.raises(BusUnavailableError, match="not the settings of that version and policy"):
            there.settings(here.twin, robot)
        said["settings"][0] = list(own[0])
        assert there.settings(here.twin, robot) == own
        said |= {"version": "another", "settings": [["drive", "fixed"]]}
        other = BusOracles.on(session).embodiment(policy)
        assert other.settings(here.twin, robot) == (("drive", "fixed"),)


@pytest.mark.oracle
def test_an_oracle_of_this_version_is_asked_where_one_of_another_is_there_too(here: Service) -> None:
    other = "kinematics 1, pin 1.0"
    with (
        open_session(listen=free_endpoint()) as session,
        replying(session, Oracle.CAUSES, lambda _: to_cbor(other)),
    ):
        assert BusOracles.on(session).physics().version == other
        with oracle(session, Oracle.CAUSES):
            assert BusOracles.on(session).physics().version == here.physics.version
