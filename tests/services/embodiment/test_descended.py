"""A door that only holds found by descent open, from where the base stands."""

from dataclasses import replace
from pathlib import Path

import pytest

from predicates.case import Verdict
from sdt_kg.annotation import Drive
from sdt_kg.task import UNKNOWN
from services.app import Service
from services.embodiment.oracle import WholeBody
from tests.services.embodiment.standing_front import (
    BUDGET,
    HERE,
    body_of,
    check_by_other_code,
    check_given_again,
    fixtures,
)

pytestmark = pytest.mark.oracle

NO_HAND_FITS = 40
"""A door that tips over, 0.74 m away: about its bar no listed or bred grasp has room at the end."""


path, service, found = fixtures(NO_HAND_FITS)


def test_it_is_certified_in_holds_that_a_descent_found(found: Verdict) -> None:
    assert body_of(found).phases[-1][0].startswith("follow")
    assert found.can_perform is not None
    assert found.can_perform.figures["holds"][0] >= 2
    assert any("by descent; let go at" in note for note in found.can_perform.notes)


def test_who_shares_no_code_with_it_finds_no_rule_broken(found: Verdict, path: Path) -> None:
    check_by_other_code(body_of(found), path)


def test_it_is_certified_again_when_somebody_gives_it(service: Service, found: Verdict) -> None:
    check_given_again(body_of(found), service)


def test_where_one_hold_is_asked_for_there_is_no_descent(found: Verdict) -> None:
    assert found.can_perform is not None
    case = replace(found.can_perform.case, body_motion=UNKNOWN)
    answer = WholeBody(Drive.FIXED, HERE, BUDGET, regrasps=False).perform(case)
    assert not answer.holds
    assert "descent" not in answer.seconds
    assert not any("by descent" in each.reason for each in answer.diagnoses)
