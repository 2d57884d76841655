"""What an oracle on the bus replies is taken for an answer only if it has the form of one."""

from collections.abc import Callable

import numpy as np
import pytest

from predicates.case import Case
from predicates.satisfies_request import demanded
from sdt_kg.errors import InputError
from sdt_kg.task import Verb
from services.app import Service
from services.bus.keys import Oracle
from services.bus.oracles.bound import UnfitReplyError, answer_to
from services.bus.oracles.codec import Plain, replayed_plain, replayed_value
from services.bus.oracles.remote import BusOracles
from services.bus.oracles.server import oracle
from services.bus.sessions import open_session
from services.judging.codec import to_cbor
from services.judging.problems import BusUnavailableError
from tests.ports import free_endpoint
from tests.services.bus.replies import DRAWER, FREE, NAN, Change, case_of, replying


def without(name: str) -> Change:
    return lambda plain: {each: value for each, value in plain.items() if each != name}


def having(**parts: object) -> Change:
    return lambda plain: plain | parts


def about(**parts: object) -> Change:
    return lambda plain: plain | {"case": plain["case"] | parts}


def moving(change: Callable[[Plain], Plain]) -> Change:
    """Another body motion."""
    return lambda plain: (
        plain
        | {
            "case": plain["case"]
            | {"body_motion": plain["case"]["body_motion"] | change(plain["case"]["body_motion"])}
        }
    )


NO_ANSWERS: list[Change] = [
    *(lambda _, value=value: value for value in ([1], None, 3, "yes")),
    *map(without, ("case", "holds", "diagnoses", "notes", "seconds", "figures", "artefact")),
    *(having(holds=value) for value in ("no", "false", 1, [0], 2.0, None)),
    *(having(notes=value) for value in (3, "abc", [1])),
    *(having(figures=value) for value in ([], {"a": 1}, {"tool slip": [0.0, "m"]}, {"a": [NAN, "m"]})),
    *(
        having(artefact=each)
        for each in (None, ["x", b""], ["proof", b"x"], ["certificate", b"x"], ["proof"])
    ),
    having(seconds={"a": "b"}),
    having(diagnoses=[{"kind": "embodiment", "reason": "no"}]),
    having(holds=False),
    *(about(robot=robot) for robot in (3, "https://example.org/id/stretch")),
    *(about(task=task) for task in (["close", None], ["dance", None], ["open"])),
    *(having(case=case) for case in ({}, [])),
    *(about(body_motion=motion) for motion in (None, 3, {})),
    moving(lambda motion: {"q": np.array(motion["q"]) + 0.1}),
    moving(lambda motion: {"q": np.array(motion["q"]) * NAN}),
    moving(lambda motion: {"times": "x"}),
    moving(lambda motion: {"gripper": 1}),
    moving(lambda motion: {"joints": "abc"}),
    moving(lambda motion: {"phases": [["drive", "first"]]}),
    moving(lambda motion: {"robot": "https://example.org/id/stretch"}),
]


@pytest.mark.parametrize("change", NO_ANSWERS, ids=range(len(NO_ANSWERS)))
def test_what_is_no_answer_is_an_error_and_never_a_certificate(
    here: Service, asked: tuple[Case, Plain], change: Change
) -> None:
    case, plain = asked
    with pytest.raises((InputError, UnfitReplyError)):
        answer_to(case, FREE, here.embodiment, change(plain))  # pyright: ignore[reportArgumentType]  # that is the point


@pytest.mark.parametrize(
    "change",
    [
        *(lambda _, value=value: value for value in ([1], None, 3, "yes")),
        *map(without, ("final", "motion", "violations", "notes", "figures")),
        *(having(final=final) for final in ({"a": "x"}, [1])),
        *(having(motion=motion) for motion in (None, {"of": 3}, {})),
        having(notes=3),
    ],
)
def test_what_no_physics_says_is_an_error(here: Service, change: Change) -> None:
    case = case_of(here, DRAWER)
    plain = replayed_plain(here.physics.replay(here.twin, case.motion))  # pyright: ignore[reportArgumentType]  # generated
    assert replayed_value(plain)
    with pytest.raises(InputError):
        replayed_value(change(plain))  # pyright: ignore[reportArgumentType]  # that is the point


@pytest.mark.oracle
@pytest.mark.parametrize("content", [b"\xff\xff", b"", to_cbor(None), to_cbor({"holds": True})])
def test_another_oracle_is_asked_where_one_replies_what_is_no_answer_and_it_is_told(
    here: Service, content: bytes
) -> None:
    goal = demanded(here.twin.container(DRAWER), Verb.OPEN)
    with (
        open_session(listen=free_endpoint()) as session,
        replying(session, Oracle.CAUSES, lambda _: content) as instance,
    ):
        with pytest.raises(BusUnavailableError, match=f"what {instance} replies is no answer to version"):
            BusOracles.on(session).physics().version  # noqa: B018 - it is asked for
        with oracle(session, Oracle.CAUSES):
            there = BusOracles.on(session).physics()
            assert there.version == here.physics.version
            assert len(list(there.generate(here.twin, goal))) == 1
