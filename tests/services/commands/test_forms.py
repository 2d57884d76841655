"""Every command says what it says as JSON and CSV too, and ends with a code of the one table."""

import contextlib
import csv
import io
import shlex
import signal
import subprocess
import sys
from collections.abc import Callable, Iterator
from pathlib import Path

import click
import pytest

from sdt_kg.load import load_twin
from services.cli import sdt as root
from services.commands.exits import MEANING, Exit
from services.commands.importing import importing
from services.stopping import Terminated, terminate
from services.store.files import SavedVerdicts
from tests.services.conftest import Done

DOOR = "open:iai_fridge_door"
STUCK = ("achieve", "--kitchen", "b", "--robot", "stretch", "--drive", "fixed", "--task", DOOR)
PLACE = ("place", "--kitchen", "b", "--robot", "stretch", "--task", DOOR)

ENDS = {
    "containers": (["containers", "b"], Exit.DONE),
    "scope": (["scope", "b"], Exit.DONE),
    "scope, outside": (["scope", "outside.urdf"], Exit.ABSTAINED),
    "query": (["query", "b", "SELECT ?door { ?door a sdt:Door }"], Exit.DONE),
    "satisfies": (["satisfies", "b"], Exit.DONE),
    "causes": (["causes", "b", "--task", DOOR], Exit.DONE),
    "causes not": (["causes", "b", "--task", DOOR, "--state", "iai_fridge_door=open"], Exit.NO),
    "causes outside": (["causes", "outside.urdf", "--task", "open"], Exit.ABSTAINED),
    "achieve not": ([*STUCK], Exit.NO),
    "why": (["why", "kept.trig"], Exit.DONE),
    "open": (["open", "kept.trig"], Exit.DONE),
    "recheck": (["recheck", "kept.trig"], Exit.DONE),
    "branch": (["branch", "b", "move:iai_fridge_door=open"], Exit.DONE),
    "diff": (["diff", "b", "b@iai_fridge_door=open"], Exit.DONE),
    "place for nothing": ([*PLACE, "--state", "iai_fridge_door=open"], Exit.NO),
    "config show": (["config", "show", "achieve"], Exit.DONE),
    "config path": (["config", "path"], Exit.DONE),
}
PLAIN = {
    "graph": (["graph", "b", "-o", "x.ttl"], Exit.DONE),
    "unknown command": (["achive"], Exit.BAD_INPUT),
    "unreadable file": (["graph", "b", "-o", "no/such/folder.ttl"], Exit.BAD_INPUT),
    "nobody on the bus": (["ask", "b", "health", "--connect", "tcp/127.0.0.1:9"], Exit.NO_ORACLE),
    "no such server": (["query", "http://127.0.0.1:9", "ASK { ?a ?b ?c }"], Exit.NO_ORACLE),
    "budget that is no number": ([*STUCK, "--budget", "nan"], Exit.BAD_INPUT),
    "no store": (["open", "/etc/passwd"], Exit.BAD_INPUT),
    "json and csv": (["containers", "b", "--json", "--csv"], Exit.BAD_INPUT),
}
# Whatever the axis is called, the shape wants a positive range: 0..0.005 is closed and open at once.
OUTSIDE = """<robot name="outside"><link name="room"/><link name="box_door"/><link name="box_handle"/>
<joint name="box_door_joint" type="revolute"><parent link="room"/><child link="box_door"/><axis xyz="0 0 1"/>
<limit lower="0" upper="0.005" effort="1" velocity="1"/></joint>
<joint name="h" type="fixed"><parent link="box_door"/><child link="box_handle"/></joint></robot>"""


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A kitchen outside D_artic, and a verdict with its proof."""
    folder = tmp_path_factory.mktemp("forms")
    (folder / "outside.urdf").write_text(OUTSIDE)
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("SDT_CONFIG", "/dev/null")
        from services.cli import run  # noqa: PLC0415 - after the setting

        assert run([*STUCK, "--save", str(folder / "kept.trig")]) == Exit.NO
    return folder


@pytest.mark.oracle
@pytest.mark.parametrize("name", ENDS)
def test_a_command_speaks_json_and_csv_and_ends_as_documented(
    sdt: Callable[..., Done], folder: Path, monkeypatch: pytest.MonkeyPatch, name: str
) -> None:
    monkeypatch.chdir(folder)
    words, code = ENDS[name]
    as_json, as_csv = sdt(*words, "--json"), sdt(*words, "--csv")
    assert (as_json.code, as_csv.code) == (code, code), as_json.err + as_csv.err
    assert as_json.json is not None
    head, *rows = csv.reader(io.StringIO(as_csv.out))
    assert len(head) > 0
    assert {len(row) for row in rows} <= {len(head)}


def test_an_opened_store_says_what_is_there_and_how_to_go_on(
    sdt: Callable[..., Done], folder: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(folder)
    found = sdt("open", "kept.trig", "--json").json
    (case,) = found["cases"]
    assert case == {
        "kitchen": "b", "robot": "stretch", "task": "open",
        "certified": 0, "not_certified": 1, "abstained": 0, "outdated": 0, "certificates": 0, "proofs": 1,
    }  # fmt: skip
    for line in found["next"][:3]:
        assert sdt(*shlex.split(line)[1:]).code == Exit.DONE, line
    assert sdt("open", "b").code == Exit.BAD_INPUT


@pytest.mark.parametrize("name", PLAIN)
def test_a_command_ends_as_documented(
    sdt: Callable[..., Done], folder: Path, monkeypatch: pytest.MonkeyPatch, name: str
) -> None:
    monkeypatch.chdir(folder)
    words, code = PLAIN[name]
    done = sdt(*words)
    assert done.code == code, done
    assert "Traceback" not in done.err


def all_commands() -> Iterator[tuple[str, click.Command]]:
    for name, command in root.commands.items():
        if isinstance(command, click.Group):
            yield from ((f"{name} {sub}", each) for sub, each in command.commands.items())
        else:
            yield name, command


SILENT = {
    "completion", "config init", "config schema", "graph", "mcp", "ontology", "oracle", "patch",
    "robot describe", "router", "serve", "tour", "view",
}  # fmt: skip
"""They write a file, print a script or schema, or run until they are stopped."""


def test_every_command_that_tells_something_tells_it_as_json() -> None:
    without = {
        name
        for name, command in all_commands()
        if "--json" not in {option for each in command.params for option in each.opts}
    }
    assert without == SILENT


def test_every_command_that_tells_rows_tells_them_as_csv() -> None:
    without = {
        name
        for name, command in all_commands()
        if "--csv" not in {option for each in command.params for option in each.opts}
    }
    # Its rows are one for each case, written as Parquet or asked of the store; a report writes CSV as assets.
    assert without == SILENT | {"report", "sweep"}


def test_every_option_says_what_it_does() -> None:
    options = [
        (name, each)
        for name, command in all_commands()
        for each in command.params
        if isinstance(each, click.Option)
    ]
    assert [f"{name} {each.opts[0]}" for name, each in options if not each.help] == []


def test_the_help_lists_every_exit_code_and_every_command(sdt: Callable[..., Done]) -> None:
    out = sdt("--help").out
    for code, meaning in MEANING.items():
        assert f"  {code.value:<11}{meaning}" in out
    assert [name for name in root.commands if f"\n  {name} " not in out] == []


def test_a_bug_is_no_verdict(sdt: Callable[..., Done], monkeypatch: pytest.MonkeyPatch) -> None:
    @click.command()
    def broken() -> None:
        raise ZeroDivisionError

    monkeypatch.setitem(root.commands, "broken", broken)
    done = sdt("broken")
    assert done.code == Exit.BUG
    assert "ZeroDivisionError" in done.err


def test_a_command_that_is_interrupted_says_so(
    sdt: Callable[..., Done], monkeypatch: pytest.MonkeyPatch
) -> None:
    @click.command()
    def interrupted() -> None:
        raise KeyboardInterrupt

    monkeypatch.setitem(root.commands, "interrupted", interrupted)
    done = sdt("interrupted")
    assert (done.code, done.out) == (Exit.INTERRUPTED, "")
    assert done.err.splitlines()[-1] == "interrupted"


def test_an_interrupt_that_python_wraps_while_a_class_is_made_is_one(
    sdt: Callable[..., Done], monkeypatch: pytest.MonkeyPatch
) -> None:
    class Named:
        def __set_name__(self, owner: type, name: str) -> None:
            raise KeyboardInterrupt

    @click.command()
    def interrupted() -> None:
        try:
            type("Made", (), {"named": Named()})
        except KeyboardInterrupt as plain:  # Python 3.12 and later wrap nothing
            raise RuntimeError from plain

    monkeypatch.setitem(root.commands, "interrupted", interrupted)
    done = sdt("interrupted")
    assert (done.code, done.err.splitlines()[-1]) == (Exit.INTERRUPTED, "interrupted")


@pytest.mark.parametrize(
    ("number", "handler", "raised"),
    [
        (signal.SIGINT, signal.default_int_handler, KeyboardInterrupt),
        (signal.SIGTERM, terminate, Terminated),
    ],
)
def test_an_interrupt_that_a_library_swallows_while_it_is_imported_is_raised_after_it(
    number: signal.Signals, handler: Callable[..., None], raised: type[BaseException]
) -> None:
    def library() -> None:
        with contextlib.suppress(BaseException):
            signal.raise_signal(number)

    before = signal.signal(number, handler)
    try:
        with pytest.raises(raised), importing():
            library()
        assert signal.getsignal(number) is handler
    finally:
        signal.signal(number, before)


def test_a_command_that_is_interrupted_says_what_it_saved(
    sdt: Callable[..., Done], monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    @click.command()
    def interrupted() -> None:
        with SavedVerdicts(tmp_path / "kept.trig"):
            raise KeyboardInterrupt

    monkeypatch.setitem(root.commands, "interrupted", interrupted)
    said = sdt("interrupted").err.splitlines()[-1]
    assert said == "interrupted: verdicts which were finished are saved"


@pytest.mark.parametrize("number", [signal.SIGTERM, signal.SIGHUP])
def test_what_is_finished_is_kept_in_a_file_when_sigterm_comes_or_the_terminal_is_closed(
    sdt: Callable[..., Done], monkeypatch: pytest.MonkeyPatch, tmp_path: Path, number: signal.Signals
) -> None:
    before = signal.signal(number, signal.SIG_DFL)  # under nohup a closed terminal is ignored

    @click.command()
    def terminated() -> None:
        with SavedVerdicts(tmp_path / "kept.trig") as saved:
            saved.add_twin(load_twin("b"))
            signal.raise_signal(number)

    monkeypatch.setitem(root.commands, "terminated", terminated)
    done = sdt("terminated")
    assert done.code == Exit.TERMINATED == 128 + signal.SIGTERM
    assert done.err.splitlines()[-1] == "terminated: verdicts which were finished are saved"
    assert (
        "sdt:Container" in (tmp_path / "kept.trig").read_text()
        or "#Container" in (tmp_path / "kept.trig").read_text()
    )
    assert signal.signal(number, before) is signal.SIG_DFL


@pytest.mark.parametrize(
    "words",
    [("query", "b", "SELECT * { ?a ?b ?c }", "--csv"), ("query", "b", "ASK {}"), ("config", "path")],
    ids=("long", "table", "short"),
)
def test_a_reader_that_goes_away_hears_no_answer(words: tuple[str, ...]) -> None:
    command = [sys.executable, "-m", "services.cli", *words]
    with subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True) as process:
        assert process.stdout is not None
        assert process.stderr is not None
        process.stdout.close()
        said = process.stderr.read()
    assert (process.returncode, said) == (Exit.BROKEN_PIPE, "")
