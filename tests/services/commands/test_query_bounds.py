"""`sdt query` ends: a query that takes too much is an error, and no cut answer."""

import os
import signal
import subprocess
import sys
from collections.abc import Callable
from functools import partial
from pathlib import Path

import pytest

from sdt_kg.errors import InputError, UnknownEntityError
from services.commands.exits import Exit
from services.store.files import query_saved
from services.store.workers import Begin, CrashedQueryError, Limit, LimitError, Limits, apart
from tests.services.conftest import Done

Sdt = Callable[..., Done]
SMALL = Path(__file__).resolve().parents[2] / "small"
FOR_EVER = "SELECT (COUNT(*) AS ?n) { ?a ?b ?c . ?d ?e ?f . ?g ?h ?i }"
WITHOUT_END = "SELECT * { ?a ?b ?c . ?d ?e ?f . ?g ?h ?i . ?j ?k ?l }"
SPENT = 1.0
"""[s] For all cases: the small robot brings its fingers to no handle, which takes as long as it may."""


def test_a_query_that_takes_too_long_is_an_error_which_names_the_option(sdt: Sdt) -> None:
    done = sdt("query", "b", "--timeout", "0.5", FOR_EVER)
    assert (done.code, done.out) == (Exit.BAD_INPUT, "")
    assert "time limit; allowed: 0.5 s, or what --timeout SECONDS says" in done.err


def test_a_query_that_takes_too_much_memory_is_an_error_which_names_the_option() -> None:
    # In a process of its own: one that is forked from here has what earlier tests gave back.
    command = [sys.executable, "-m", "services.cli", "query", "b", "--memory", "0.1", WITHOUT_END]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    assert (done.returncode, done.stdout) == (Exit.BAD_INPUT, "")
    assert "memory limit; allowed: 0.1 GiB, or what --memory GIB says" in done.stderr


def test_saved_verdicts_are_asked_within_the_same_limits(sdt: Sdt, tmp_path: Path) -> None:
    (tmp_path / "few.nq").write_text("".join(f"<a:{n}> <a:b> <a:{n}> <a:g> .\n" for n in range(2000)))
    done = sdt("query", str(tmp_path / "few.nq"), "--timeout", "0.5", FOR_EVER)
    assert done.code == Exit.BAD_INPUT
    assert "time limit" in done.err


CASES = "SELECT (STR(COUNT(*)) AS ?container) { ?a ?b ?c . ?d ?e ?f . ?g ?h ?i }"


def test_the_query_of_a_sweep_is_asked_within_the_same_limits(sdt: Sdt, tmp_path: Path) -> None:
    few = tmp_path / "few.nq"
    few.write_text("".join(f"<a:{n}> <a:b> <a:{n}> <a:g> .\n" for n in range(2000)))
    for of in ((), ("--of", str(few))):
        done = sdt("sweep", "--kitchens", "b", "--query", CASES, *of, "--timeout", "0.5", "--plan")
        assert (done.code, done.out) == (Exit.BAD_INPUT, "")
        assert "time limit; allowed: 0.5 s, or what --timeout SECONDS says" in done.err


def test_from_python_saved_verdicts_are_asked_within_limits(tmp_path: Path) -> None:
    few = tmp_path / "few.nq"
    few.write_text("".join(f"<a:{n}> <a:b> <a:{n}> <a:g> .\n" for n in range(2000)))
    assert query_saved(few, "SELECT (COUNT(*) AS ?n) { ?a ?b ?c }") == (["n"], [{"n": 2000}])
    with pytest.raises(LimitError, match=r"time limit; allowed: 0\.5 s"):
        query_saved(few, FOR_EVER, Limits(seconds=0.5))


def test_what_was_computed_is_kept_where_the_query_takes_too_long(sdt: Sdt, tmp_path: Path) -> None:
    store, small = str(tmp_path / "store"), [str(SMALL / "b.urdf"), str(SMALL / "pr2.urdf")]
    judged = "SELECT (COUNT(*) AS ?n) { ?v law:causes ?any . ?d ?e ?f . ?g ?h ?i . ?j ?k ?l . ?m ?n1 ?o }"
    few = ("--kitchen", small[0], "--robot", small[1], "--budget", str(SPENT))
    command = ("--compute", *few, "--jobs", "1", "--timeout", "0.5")
    done = sdt("query", store, judged, *command)
    assert done.code == Exit.BAD_INPUT
    assert "time limit" in done.err
    assert len(sdt("query", store, "SELECT ?v { ?v law:causes ?any }", "--json").json) > 0


def test_in_the_background_of_a_shell_a_query_hears_no_interrupt() -> None:
    before = signal.signal(signal.SIGINT, signal.SIG_IGN)
    try:
        with apart(Limits()) as ask:
            assert ask(_hears_of_interrupts) is False
    finally:
        signal.signal(signal.SIGINT, before)


def test_a_question_that_gets_no_memory_traces_nothing_and_waits_for_no_lock(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setenv("RUST_BACKTRACE", "1")
    with apart(Limits()) as ask:
        assert ask(_traces) == "0"


@pytest.mark.parametrize("error", [UnknownEntityError("joint", "dor", ["door"]), LimitError(Limit.ROWS, "5")])
def test_errors_come_back_as_they_are(error: InputError) -> None:
    with apart(Limits()) as ask, pytest.raises(type(error)) as told:
        ask(partial(_fails, error))
    assert str(told.value) == str(error)
    assert vars(told.value) == vars(error)


def test_a_process_that_dies_is_an_error() -> None:
    with apart(Limits()) as ask, pytest.raises(CrashedQueryError, match="signal 9"):
        ask(_dies)


def _hears_of_interrupts(begin: Begin) -> bool:
    begin()
    return signal.getsignal(signal.SIGINT) is not signal.SIG_IGN


def _traces(begin: Begin) -> str:
    begin()
    return os.environ["RUST_BACKTRACE"]


def _fails(error: InputError, begin: Begin) -> None:
    begin()
    raise error


def _dies(begin: Begin) -> None:
    begin()
    signal.raise_signal(signal.SIGKILL)
