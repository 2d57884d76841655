"""Descents, too, give the same motion for the same seed; in `make test` grippers in turn do."""

from pathlib import Path

import pytest

from predicates.case import Verdict
from tests.services.embodiment.standing_front import body_of, check_found_again
from tests.services.embodiment.test_descended import found, path, service  # noqa: F401 - fixtures

pytestmark = [pytest.mark.oracle, pytest.mark.slow]


def test_the_same_seed_gives_the_same_motion(found: Verdict, path: Path) -> None:  # noqa: F811 - fixtures
    check_found_again(body_of(found), path)
