"""Every size and every pair of edits, over HTTP as on the shell, in the time that all of them take."""

import pytest

from tests.services.conftest import loggers, sdt  # noqa: F401 - fixtures
from tests.services.http.conftest import serve  # noqa: F401 - the fixture
from tests.services.http.test_other_worlds import served, turned  # noqa: F401 - a fixture

pytestmark = [pytest.mark.oracle, pytest.mark.slow]


def test_all_edits_are_answered_as_on_the_shell(served, sdt) -> None:  # noqa: F811 - the fixtures
    there, here = turned(served, sdt, 100)
    assert there == here
    assert not any(each["stopped"] for each in here["families"])
