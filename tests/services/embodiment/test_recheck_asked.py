"""A stored verdict about a τ with times: a recheck compares τ with what the robot does."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from predicates.case import Artefact, Case, Outcome
from predicates.law import law
from sdt_kg.annotation import Drive
from sdt_kg.motion import Motion
from sdt_kg.task import Task, Verb
from services.embodiment.certify.asked import OFF
from services.embodiment.certify.certificate import Certificate, read_certificate
from services.embodiment.oracle import WholeBody
from services.embodiment.recheck import Rechecked, Saved, recheck_verdict
from services.physics.oracle import Kinematics
from services.store.files import SavedVerdicts
from tests.services.embodiment.gantry import DRAWER, START, gantry_twin, opening

pytestmark = pytest.mark.oracle


@pytest.fixture(scope="module")
def file(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A verdict about τ and a body motion that keeps it."""
    folder, body = tmp_path_factory.mktemp("asked"), opening()
    twin, follow = gantry_twin(folder), body.times >= 11.0 - 1e-9
    arrays = body.times[follow], body.kitchen_q[follow]
    asked = Motion(DRAWER, *arrays, timed=True, velocities=body.kitchen_v[follow])
    task = Task(Verb.OPEN, twin.container("drawer_main").iri)
    case = Case(twin, twin.robots[0], task, asked, body_motion=body)
    (verdict,) = law(case, Kinematics(), WholeBody(Drive.OMNI, START))
    assert verdict.outcome is Outcome.CERTIFIED
    kept = folder / "kept.nq"
    with SavedVerdicts(kept) as saved:
        saved.add_twin(twin)
        saved.add(verdict)
    return kept


def recheck(file: Path, certificate: Certificate | None = None) -> Rechecked:
    saved = Saved(file)
    (entry,) = saved.entries()
    assert entry.stored is not None
    assert entry.artefact is not None
    artefact = entry.artefact
    if certificate is not None:
        artefact = Artefact(artefact.kind, certificate.content())
    return recheck_verdict(entry.stored, artefact, saved.twin)


def stored(file: Path) -> Certificate:
    (entry,) = Saved(file).entries()
    assert entry.artefact is not None
    return read_certificate(entry.artefact.content)


def test_the_motion_that_was_asked_for_is_compared(file: Path) -> None:
    found = recheck(file)
    assert found.reasons == ()
    assert found.notes == ("models of the saved graphs",)


def test_without_it_the_certificate_does_not_hold(file: Path) -> None:
    certificate = stored(file)
    figures = {name: each for name, each in certificate.figures.items() if name != OFF}
    found = recheck(file, replace(certificate, asked=None, figures=figures))
    assert found.reasons == (
        "the verdict is about a motion that was asked for, and its certificate has none",
    )


def test_of_another_than_the_verdict_was_asked_about_the_recheck_says_that_it_was_not_compared(
    file: Path,
) -> None:
    certificate = stored(file)
    asked = certificate.asked
    assert asked is not None
    found = recheck(file, replace(certificate, asked=replace(asked, times=asked.times + 1.0)))
    assert any("was not compared" in note for note in found.notes)


def test_a_body_motion_that_goes_elsewhere_meanwhile_does_not_hold(file: Path) -> None:
    certificate = stored(file)
    asked = certificate.asked
    assert asked is not None
    slower = replace(asked, times=1.2 * asked.times, velocities=np.asarray(asked.velocities) / 1.2)
    found = recheck(file, replace(certificate, asked=slower))
    assert "off the motion that was asked for" in found.reasons[0]
