"""The tour shows commands as they are; it is walked whole in tests/soak."""

from collections.abc import Callable

import click
import pytest

from services.cli import sdt as root
from services.tour.steps import STEPS
from tests.services.conftest import Done


def test_the_list_shows_what_would_be_typed_and_runs_nothing(sdt: Callable[..., Done]) -> None:
    done = sdt("tour", "--list")
    assert done.code == 0
    assert done.out.count("    sdt ") == len(STEPS)
    assert "certified" not in done.out


@pytest.mark.parametrize("step", STEPS, ids=lambda step: step.title)
def test_each_command_is_one_that_sdt_takes(step: object) -> None:
    name, *words = step.words
    command = root.commands[name]
    context = command.make_context(name, words, resilient_parsing=True)
    taken = {option for parameter in command.params for option in parameter.opts}
    assert [word for word in words if word.startswith("--") and word not in taken] == []
    assert isinstance(context, click.Context)
    assert context.args == []
