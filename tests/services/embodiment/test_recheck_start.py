"""A certificate of a robot that started beside the kitchen's start pose is rechecked by what stood there."""

from dataclasses import replace
from pathlib import Path

import pytest

from predicates.case import Case, Outcome
from predicates.law import law
from sdt_kg.annotation import Drive
from sdt_kg.load import load_twin
from sdt_kg.state import State
from sdt_kg.task import Task, Verb
from services.embodiment.certify.certificate import read_certificate
from services.embodiment.oracle import WholeBody
from services.embodiment.recheck import Saved
from services.embodiment.recheck.embodiment import Certifier
from services.physics.oracle import Kinematics
from services.store.files import SavedVerdicts
from tests.services.embodiment.test_recheck import recheck

pytestmark = pytest.mark.oracle


@pytest.fixture(scope="module")
def kept_beside(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A verdict whose robot could not begin at the kitchen's start pose, for open drawers stand there."""
    twin = load_twin("a", ["tiago_dual"])
    state = twin.at({one.joint: one.upper for one in twin.containers()})
    task = Task(Verb.CLOSE, twin.container("cabinet1_drawer_bottom").iri)
    (verdict,) = law(Case(state, twin.robots[0], task), Kinematics(), WholeBody(Drive.OMNI))
    assert verdict.outcome is Outcome.CERTIFIED
    file = tmp_path_factory.mktemp("beside") / "beside.nq"
    with SavedVerdicts(file) as saved:
        saved.add_twin(state)
        saved.add(verdict)
    return file


def test_a_start_beside_the_kitchens_holds_where_that_one_is_not_free(kept_beside: Path) -> None:
    found = recheck(kept_beside)
    assert found.reasons == ()
    assert any(note.endswith("not that no free pose is nearer to it") for note in found.notes)


def test_a_start_beside_the_kitchens_is_refused_where_that_one_is_free(kept_beside: Path) -> None:
    (entry,) = Saved(kept_beside).entries()
    assert entry.artefact is not None
    certificate = read_certificate(entry.artefact.content)
    assert certificate.start is not None
    twin = load_twin("a", ["tiago_dual"])
    x, y, _ = twin.kitchen().start
    said = f"{x:g}, {y:g}, 0, or the nearest that is free, turned to the handle"
    opened = twin.at(State.of(certificate.state))
    assert Certifier(opened, certificate).starts_as(said)
    assert not Certifier(twin, certificate).starts_as(said)  # everything is closed: nothing is in the way
    turned = replace(certificate, start=(*certificate.start[:2], certificate.start[2] + 9e-4))
    assert not Certifier(opened, turned).starts_as(said)
