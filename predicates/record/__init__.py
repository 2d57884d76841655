"""Verdicts as triples and as JSON: what was asked, what was answered, from which inputs."""

from predicates.record.artefacts import read_artefact
from predicates.record.report import diagnosis_json, to_json
from predicates.record.stored import StoredVerdict, read_verdict, read_verdicts, verdict_records, verdicts_of
from predicates.record.triples import Record, gives_way, to_record, write

__all__ = [
    "Record",
    "StoredVerdict",
    "diagnosis_json",
    "gives_way",
    "read_artefact",
    "read_verdict",
    "read_verdicts",
    "to_json",
    "to_record",
    "verdict_records",
    "verdicts_of",
    "write",
]
