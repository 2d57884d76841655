"""The tour, walked on a pipe from end to end."""

from pathlib import Path

import pytest
from click.testing import CliRunner

from services.cli import sdt
from services.tour.steps import MOTION, STEPS, TRACK, VERDICTS


@pytest.mark.oracle
@pytest.mark.slow
def test_every_step_of_the_tour_ends_as_it_says(tmp_path: Path) -> None:
    done = CliRunner().invoke(sdt, ["tour", "--keep", str(tmp_path)], env={"SDT_CONFIG": "/dev/null"})
    assert done.exit_code == 0, done.output
    assert {each.name for each in tmp_path.iterdir()} == {MOTION, TRACK, VERDICTS}
    assert f"{len(STEPS)} of {len(STEPS)}" in done.output
    for shown in ("certified", "open:iai_fridge_door", "(proved)", "CERTIFIED", "1 of 1 hold"):
        assert shown in done.output
