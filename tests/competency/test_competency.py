"""Competency questions: `ontology/queries/cqNN_….rq`, and here what is answered, and what after an edit.

`cqNN_….expected.csv` is the answer. `cqNN_….negative.ru` is the negative twin: it edits a copy of the data
so that the answer must be another one, and its lines `# Loses` and `# Gains` say exactly which rows go and
come.
They are asked of verdicts that `law` really gave, about small kitchens named a and b and lifts named
pr2 and stretch (tests/small). A new answer is written by `UPDATE_EXPECTED=1 pytest tests/competency`
and read before it is committed.
"""

import csv
import io
import os
from collections import Counter
from pathlib import Path

import pyoxigraph as ox
import pytest

import ontology
from sdt_kg.iri import local_name
from sdt_kg.store import checked_query, rows_of

QUERIES = sorted(Path(str(ontology.path("queries"))).glob("cq*.rq"))


def answer(store: ox.Store, query: Path) -> str:
    """The rows as CSV, IRIs as the names of what they name."""
    columns, rows = rows_of(store.query(checked_query(query.read_text()), use_default_graph_as_union=True))
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(columns)
    writer.writerows([_cell(row[column]) for column in columns] for row in rows)
    return text.getvalue()


def _cell(value: object) -> str:
    if isinstance(value, float):
        return f"{value:.6g}"
    text = str(value)
    return local_name(text) if text.startswith("https://") else text


def test_there_are_competency_questions() -> None:
    assert len(QUERIES) >= 25


@pytest.mark.parametrize("query", QUERIES, ids=lambda path: path.stem)
def test_competency(verdicts: ox.Store, query: Path) -> None:
    expected = Path(__file__).with_name(f"{query.stem}.expected.csv")
    found = answer(verdicts, query)
    if os.environ.get("UPDATE_EXPECTED"):
        expected.write_text(found)
    assert len(found.splitlines()) > 1, "a question without an answer tests nothing"
    assert found == expected.read_text()


def test_every_expected_answer_has_its_question() -> None:
    answers = {
        path.name.removesuffix(".expected.csv") for path in Path(__file__).parent.glob("*.expected.csv")
    }
    assert answers == {path.stem for path in QUERIES}
    negatives = {
        path.name.removesuffix(".negative.ru") for path in Path(__file__).parent.glob("*.negative.ru")
    }
    assert negatives == answers


@pytest.mark.parametrize("query", QUERIES, ids=lambda path: path.stem)
def test_the_negative_twin_has_another_answer_and_says_which(verdicts: ox.Store, query: Path) -> None:
    file = Path(__file__).with_name(f"{query.stem}.negative.ru")
    text, edited = file.read_text(), ox.Store()
    edited.extend(verdicts)
    edited.update(text)
    before, after = (Counter(answer(store, query).splitlines()) for store in (verdicts, edited))
    lost, gained = sorted((before - after).elements()), sorted((after - before).elements())
    if os.environ.get("UPDATE_EXPECTED"):
        kept = [line for line in text.splitlines() if not line.startswith(("# Loses", "# Gains"))]
        stated = [f"# Loses  {row}" for row in lost] + [f"# Gains  {row}" for row in gained]
        file.write_text("\n".join([kept[0], *stated, *kept[1:]]) + "\n")
    stated = [
        line.split("  ", 1) for line in file.read_text().splitlines() if line[:7] in {"# Loses", "# Gains"}
    ]
    assert lost or gained, "an edit that changes no answer tests nothing"
    assert sorted(row for kind, row in stated if kind == "# Loses") == lost
    assert sorted(row for kind, row in stated if kind == "# Gains") == gained
