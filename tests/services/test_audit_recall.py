"""A record that was changed in its store answers no question, neither another one nor its own."""

from dataclasses import replace

import pytest

from predicates.case import Artefact, ArtefactKind, Outcome
from predicates.record.recall import Recall
from predicates.record.stored import StoredVerdict
from sdt_kg.annotation import Drive
from sdt_kg.errors import InputError
from sdt_kg.iri import Iri
from services.app import Policy, Service
from services.embodiment.certify.certificate import read_certificate
from services.store.files import SavedVerdicts
from tests.services.embodiment.gantry import gantry_twin, opening

pytestmark = pytest.mark.oracle


@pytest.fixture(scope="module")
def asked(tmp_path_factory: pytest.TempPathFactory) -> tuple[Service, StoredVerdict]:
    """The question, and what a store says of it."""
    folder = tmp_path_factory.mktemp("stored")
    service = Service(gantry_twin(folder), Policy(Drive.OMNI, (0.0, 0.0, 0.0)))
    (verdict,) = service.achieve("open:drawer_main", motion=opening())
    with SavedVerdicts(folder / "kept.nq") as saved:
        saved.add(verdict)
        stored = saved.stored(verdict.iri)
    assert stored is not None
    assert stored.outcome is Outcome.CERTIFIED
    return service, stored


def answered(asked: tuple[Service, StoredVerdict], changed: StoredVerdict) -> Outcome:
    service, stored = asked

    def recall(iri: Iri) -> StoredVerdict | None:
        return changed if iri == stored.iri else None

    told: Recall = recall
    (verdict,) = replace(service, recall=told).achieve("open:drawer_main", motion=opening())
    assert verdict.stored
    return verdict.outcome


def with_certificate(stored: StoredVerdict, **changes: object) -> StoredVerdict:
    assert stored.artefact is not None
    certificate = replace(read_certificate(stored.artefact.content), **changes)  # type: ignore[arg-type]
    return replace(stored, artefact=Artefact(ArtefactKind.CERTIFICATE, certificate.content()))


def test_what_was_stored_is_told_with_its_motion(asked: tuple[Service, StoredVerdict]) -> None:
    assert answered(asked, asked[1]) is Outcome.CERTIFIED


def test_a_record_with_the_inputs_of_another_question_is_damaged(
    asked: tuple[Service, StoredVerdict],
) -> None:
    stored = asked[1]
    inputs = tuple((name, "fixed" if name == "embodiment.drive" else value) for name, value in stored.inputs)
    with pytest.raises(InputError, match="other inputs"):
        answered(asked, replace(stored, inputs=inputs))


@pytest.mark.parametrize("change", [{"can_perform": False}, {"causes": None}, {"outcome": Outcome.ABSTAINED}])
def test_an_outcome_that_its_answers_do_not_give_is_damage(
    asked: tuple[Service, StoredVerdict], change: dict[str, object]
) -> None:
    with pytest.raises(InputError, match="its answers and diagnoses do not"):
        answered(asked, replace(asked[1], **change))  # type: ignore[arg-type]


def test_certified_needs_the_certificate_of_this_question(asked: tuple[Service, StoredVerdict]) -> None:
    stored = asked[1]
    with pytest.raises(InputError, match="without a certificate"):
        answered(asked, replace(stored, artefact=None))
    with pytest.raises(InputError, match="another drive"):
        answered(asked, with_certificate(stored, drive=Drive.FIXED))
    with pytest.raises(InputError, match="another container"):
        answered(asked, with_certificate(stored, container="https://example.org/id/cell/body/other"))
    with pytest.raises(InputError, match="another state"):
        answered(asked, with_certificate(stored, state={}))
