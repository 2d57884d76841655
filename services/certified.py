"""A stored verdict is certified by its certificate, and by no other one."""

from dataclasses import replace

from predicates.case import ArtefactKind, Outcome, Verdict
from predicates.record.recall import REMEDY
from sdt_kg.errors import InputError
from sdt_kg.task import UNKNOWN, Task


def with_motion(verdict: Verdict) -> Verdict:
    """A stored verdict with the body motion that its certificate holds.

    Raises:
        InputError: It says certified, and has no certificate, or that of something else.
    """
    if not verdict.stored or verdict.outcome is not Outcome.CERTIFIED:
        return verdict
    from services.embodiment.certify.certificate import read_certificate  # noqa: PLC0415 - only for stored verdicts

    artefact = None if verdict.can_perform is None else verdict.can_perform.artefact
    if artefact is None or artefact.kind is not ArtefactKind.CERTIFICATE:
        raise InputError(
            f"the stored verdict {verdict.iri} is certified without a certificate", remedy=REMEDY
        )
    certificate = read_certificate(artefact.content)
    case, said = verdict.case, dict(verdict.inputs)
    certified = {
        "environment": " ".join(certificate.models[0]),
        "robot": " ".join(certificate.models[1]),
        "embodiment.drive": certificate.drive.value,
        "embodiment.tolerances": repr(certificate.tolerances),
    }
    other = [name for name, value in certified.items() if said.get(name, value) != value]
    if certificate.state != dict(case.twin.state):
        other.append("state")
    if isinstance(case.task, Task) and case.task.container not in {UNKNOWN, certificate.container}:
        other.append("container")
    if other:
        what = f"has a certificate about another {other[0].removeprefix('embodiment.')}"
        raise InputError(f"the stored verdict {verdict.iri} {what}", remedy=REMEDY)
    return replace(verdict, case=replace(case, body_motion=certificate.motion))
