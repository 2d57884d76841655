"""What a table and a bar look like where nobody or somebody watches."""

import pytest

from services.commands.terminal import bar_of, print_table

LONG = "word " * 200


def test_on_a_pipe_each_row_is_one_line_however_long(capsys: pytest.CaptureFixture[str]) -> None:
    print_table(("name", "why"), [("door", LONG), ("drawer", "none")])
    head, first, second = capsys.readouterr().out.splitlines()
    assert (head.split(), second.split()) == (["name", "why"], ["drawer", "none"])
    assert first.split() == ["door", *LONG.split()]


@pytest.mark.parametrize(("total", "said"), [(27, "3/27 containers"), (0, "3/? containers")])
def test_a_bar_says_what_it_counts(total: int, said: str, capsys: pytest.CaptureFixture[str]) -> None:
    with bar_of("open", total, "containers") as bar:
        bar.update(bar.task_ids[0], advance=3)
        bar.console.print(bar.get_renderable())
    assert said in " ".join(capsys.readouterr().err.split())
