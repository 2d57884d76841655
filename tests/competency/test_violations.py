"""What must not be: `ontology/checks/….violation.rq` finds nothing in real data, and something in its edit.

`violations/….ru` is the edit of a copy of the data after which the check must find a row.
"""

import re
from pathlib import Path

import pyoxigraph as ox
import pytest

import ontology
from sdt_kg.iri import joint_iri
from sdt_kg.load import load_twin
from sdt_kg.store import checked_query, rows_of

CHECKS = sorted(Path(str(ontology.path("checks"))).glob("*.violation.rq"))
EDITS = Path(__file__).with_name("violations")


def found(store: ox.Store, check: Path) -> list[dict[str, object]]:
    return rows_of(store.query(checked_query(check.read_text()), use_default_graph_as_union=True))[1]


def edit_of(check: Path) -> Path:
    return EDITS / check.name.replace(".violation.rq", ".ru")


def test_every_check_has_its_edit() -> None:
    assert len(CHECKS) >= 12
    assert {edit_of(check) for check in CHECKS} == set(EDITS.iterdir())


@pytest.mark.parametrize("check", CHECKS, ids=lambda path: path.name.partition(".")[0])
def test_nothing_is_violated_and_the_edit_is_caught(verdicts: ox.Store, check: Path) -> None:
    heads = re.findall(r"^# (\w+) ", check.read_text(), flags=re.MULTILINE)
    assert {"Must", "Source", "Returns"} <= set(heads)
    assert found(verdicts, check) == []
    edited = ox.Store()
    edited.extend(verdicts)
    edited.update(edit_of(check).read_text())
    assert found(edited, check) != []


@pytest.mark.parametrize("kitchen", ["a", "b"])
def test_the_bundled_kitchens_violate_nothing(kitchen: str) -> None:
    twin = load_twin(kitchen, ["pr2", "tiago_dual", "stretch"])
    store = twin.entities.store.dump(twin.graphs())
    assert {check.name: found(store, check) for check in CHECKS} == {check.name: [] for check in CHECKS}


def test_a_joint_that_follows_another_to_its_limit_is_not_beyond_it_by_rounding(tmp_path: Path) -> None:
    turns = "".join(
        f'<link name="{name}_link"/><joint name="{name}" type="revolute"><parent link="world"/>'
        f'<child link="{name}_link"/><limit lower="0" upper="{upper}" velocity="1" effort="1"/>{more}</joint>'
        for name, upper, more in (
            ("turn", 1.0, ""),
            ("follow", 0.7, '<mimic joint="turn" multiplier="1.2"/>'),
        )
    )
    file = tmp_path / "k.urdf"
    file.write_text(f'<robot name="k"><link name="world"/>{turns}</robot>')
    twin = load_twin(file).at({joint_iri("k", "follow"): 0.7})
    assert twin.state[joint_iri("k", "follow")] > 0.7
    (check,) = (each for each in CHECKS if each.name.startswith("position_outside"))
    assert found(twin.entities.store.dump(twin.graphs()), check) == []
