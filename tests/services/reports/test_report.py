"""`sdt report`: one file that loads nothing, what papers take, and errors as on the shell."""

import json
import os
import re
import sys
from html.parser import HTMLParser
from pathlib import Path

import nbformat
import pytest
from click.testing import CliRunner
from papermill.exceptions import PapermillExecutionError

from sdt_kg.errors import InputError, SdtError, UnknownEntityError
from services.reports.command import report
from services.reports.run.build import BrokenReportError, executed, told_as
from services.reports.run.catalogue import Notebook, Parameter
from services.reports.run.export import write
from services.reports.studies import counterfactual
from services.reports.studies.judged import judged
from tests.services.reports.conftest import DRAWER, Written

SMALL = Path(__file__).resolve().parents[2] / "small"

LOADING = {"src", "href", "srcset", "data", "poster", "action", "xlink:href"}


class Loads(HTMLParser):
    """What a page would load."""

    def __init__(self) -> None:
        super().__init__()
        self.addresses = list[str]()
        self.tags = set[str]()
        self.policy = ""

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        found = dict(attrs)
        self.tags.add(tag)
        self.addresses += [str(found[name]) for name in LOADING & found.keys() if tag != "a"]
        if tag == "meta" and found.get("http-equiv") == "Content-Security-Policy":
            self.policy = str(found["content"])


def test_the_page_loads_nothing_and_forbids_the_browser_to(written: Written) -> None:
    page = Loads()
    page.feed(written.text)
    assert [each for each in page.addresses if not each.startswith("data:")] == []
    assert "default-src 'none'" in page.policy
    assert not {"iframe", "object", "embed", "base"} & page.tags
    style = "".join(re.findall(r"<style.*?</style>", written.text, flags=re.DOTALL))
    assert "url(" not in style
    assert "@import" not in style
    for library in ("require.min.js", "MathJax", "mermaid", "jquery"):
        assert library not in written.text


def test_the_page_tells_counts_parameters_and_what_is_not_claimed(written: Written) -> None:
    words = written.words()
    assert re.search(r"stretch 1 1 0 0 0 0 0", words)
    assert f"task open:{DRAWER}" in words
    assert "no friction" in words
    assert "Traceback" not in words
    assert len(written.text) < 10e6


def test_a_second_report_is_answered_from_the_store(written: Written) -> None:
    found = judged("b", "stretch", f"open:{DRAWER}", drive="omni", budget=30.0, store=str(written.store))
    assert found.computed == 0
    assert [each.certified for each in found.all] == [True]


def test_a_store_that_can_only_be_read_is_enough_where_all_is_there(
    written: Written, monkeypatch: pytest.MonkeyPatch
) -> None:
    access, before = os.access, written.store.read_bytes()
    monkeypatch.setattr(os, "access", lambda path, mode: mode != os.W_OK and access(path, mode))
    options = {"drive": "omni", "budget": 30.0, "store": str(written.store)}
    assert judged("b", "stretch", f"open:{DRAWER}", **options).computed == 0
    with pytest.raises(InputError, match=r"1 verdicts of the report are not in .* can only be read"):
        judged("b", "stretch", "open:iai_fridge_door", **options)
    assert written.store.read_bytes() == before


def test_each_container_is_judged_from_where_it_alone_is_open() -> None:
    asked = f"close:{DRAWER},iai_fridge_door"
    found = judged("b", "stretch", asked, state="asked=open", drive="omni", budget=30.0)
    states = [[each for each in one.verdict.case.twin.state.values() if each] for one in found.all]
    assert [len(each) for each in states] == [1, 1]
    assert [each.certified for each in found.all] == [True, True]


def test_assets_are_what_papers_take(written: Written) -> None:
    names = {each.name for each in written.assets.iterdir()}
    assert {"feasibility_matrix.svg", "feasibility_matrix.pdf", "feasibility_counts.csv"} <= names
    assert (written.assets / "feasibility_counts.tex").read_text().startswith(r"\begin{table}")
    assert (written.assets / "feasibility_scene.pdf").read_bytes().startswith(b"%PDF")
    head, row = (written.assets / "feasibility_counts.csv").read_text().splitlines()
    assert dict(zip(head.split(","), row.split(","), strict=False))["certified"] == "1"


def small(code: str) -> Notebook:
    """A notebook of one cell."""
    cells = [
        nbformat.v4.new_markdown_cell("# What?"),
        nbformat.v4.new_code_cell("x = 1", metadata={"tags": ["parameters"]}),
        nbformat.v4.new_code_cell(code),
    ]
    return Notebook("small", "What?", (Parameter("x", 1, "a number"),), nbformat.v4.new_notebook(cells=cells))


LOOPBACK = "0100007F"
PORTS = """
import json, os, pathlib, sys
links = [os.readlink(each) for each in pathlib.Path("/proc/self/fd").iterdir() if each.is_symlink()]
own = {each[8:-1] for each in links if each.startswith("socket:")}
tables = [pathlib.Path(f"/proc/net/{name}").read_text() for name in ("tcp", "tcp6", "udp", "udp6")]
inet = [line for table in tables for line in table.splitlines()[1:] if line.split()[9] in own]
print(json.dumps({"sockets": len(own), "inet": inet, "python": sys.executable, "x": x}))
"""


def test_a_notebook_runs_in_this_interpreter_and_listens_to_nobody_else() -> None:
    node = executed(small(PORTS), {"x": 5})
    found = json.loads("".join(each["text"] for each in node.cells[-1].outputs))
    assert found["sockets"] > 0
    # ipykernel's own pipe for the output of child processes, on loopback
    assert [each.split()[1].split(":")[0] for each in found["inet"]] in ([], [LOOPBACK])
    assert (found["python"], found["x"]) == (sys.executable, 5)


def test_a_notebook_imports_nothing_from_the_current_folder(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "services.py").write_text("raise ImportError('imported from the current folder')")
    monkeypatch.chdir(tmp_path)
    node = executed(small("import services; print(services.__file__)"), {})
    assert node.cells[-1].outputs[0]["text"].strip().endswith("services/__init__.py")


def test_a_notebook_imports_from_where_the_callers_path_says(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "beside.py").write_text("")
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("PYTHONPATH", ".")
    monkeypatch.setenv("PYTHONSAFEPATH", "1")  # as `sdt` sets it
    node = executed(small("import beside; print(beside.__file__)"), {})
    assert node.cells[-1].outputs[0]["text"].strip() == str(tmp_path / "beside.py")


SHOWN = """
from IPython.display import display
from services import load
from services.table import TableResult

kitchen = load("{kitchen}", robots=["{robot}"])
for each in (kitchen.twin, *kitchen.achieve("open:swing_door"), TableResult()):
    display(each)
"""


def test_a_twin_a_verdict_and_a_table_show_themselves_in_a_notebook_that_runs() -> None:
    files = {name: str(SMALL / f"{file}.urdf") for name, file in (("kitchen", "a"), ("robot", "stretch"))}
    outputs = executed(small(SHOWN.format(**files)), {}).cells[-1].outputs
    twin, verdict, table = ("".join(each["data"]["text/html"]) for each in outputs)
    assert "Twin of kitchen a" in twin
    assert ">abstained<" in verdict
    assert "<table" in table


def test_an_error_of_ours_in_a_cell_is_the_same_line_as_on_the_shell() -> None:
    code = "from sdt_kg.errors import UnknownEntityError\nraise UnknownEntityError('door', 'dor', ['door'])"
    with pytest.raises(InputError) as told:
        executed(small(code), {})
    assert str(told.value) == str(UnknownEntityError("door", "dor", ["door"]))


def ended_with(name: str, message: str) -> Exception:
    """What the shell gets where a cell ends with this error."""
    return told_as(small("1"), PapermillExecutionError(2, 3, "1", name, message, [f"{name}: {message}"]))


def test_an_oracle_that_does_not_answer_is_no_bad_input_and_a_bug_is_told_whole() -> None:
    silent, bug = ended_with("OracleUnavailableError", "nobody answered"), ended_with("KeyError", "'k'")
    assert isinstance(silent, SdtError)
    assert not isinstance(silent, InputError)
    assert str(silent) == "nobody answered"
    assert isinstance(bug, BrokenReportError)
    assert "cell 3 of the report small" in str(bug)
    assert "KeyError: 'k'" in str(bug)


def run(*words: str) -> object:
    return CliRunner().invoke(report, words, catch_exceptions=True)


def test_the_list_names_every_report_and_parameter() -> None:
    result = run("--list")
    assert result.exit_code == 0
    assert "feasibility: Which robot achieves what in this kitchen?" in result.output
    rows = json.loads(run("--list", "--json").output)
    assert {"report", "question", "parameter", "default", "meaning"} == set(rows[0])


@pytest.mark.parametrize(
    ("words", "message"),
    [
        ((), "no report is named; sdt report --list"),
        (("feasability",), "did you mean 'feasibility'"),
        (("feasibility", "-p", "robot=pr2"), "did you mean 'robots'"),
        (("feasibility", "-o", "report.pdf"), "FILE.html"),
        (("feasibility", "-o", "no/such/folder/report.html"), "a folder that is there"),
        (("learning", "--store", "x.nq"), "no parameter of the report learning named 'store'"),
    ],
)
def test_nonsense_is_refused_before_anything_runs(words: tuple[str, ...], message: str) -> None:
    error = run(*words).exception
    assert isinstance(error, InputError)
    assert message in str(error)


def test_an_edit_that_no_robot_sees_made_is_refused_before_anything_is_judged() -> None:
    with pytest.raises(
        InputError, match="no container named 'iai_fridge_dor'; did you mean 'iai_fridge_door'"
    ):
        counterfactual.judged("b", "pr2,stretch", "open:iai_fridge_door", "drive:fixed; jam:iai_fridge_dor")


def test_without_the_extra_the_error_says_what_to_install(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("services.reports.command.NEEDED", ("papermill", "a_package_that_is_not_there"))
    error = run("--list").exception
    assert isinstance(error, InputError)
    assert "pip install 'sdt-kg[notebook]'" in str(error)


def test_the_executed_notebook_can_be_kept(tmp_path: Path) -> None:
    notebook = small("1 + 1")
    write(tmp_path / "small.ipynb", notebook, notebook.node, {})
    assert nbformat.read(tmp_path / "small.ipynb", as_version=4).cells[-1].source == "1 + 1"
