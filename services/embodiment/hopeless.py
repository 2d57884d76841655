"""Motions of a container for which no robot need be searched: nobody is certified to move it so."""

import time
from collections.abc import Callable
from dataclasses import dataclass

from predicates.case import Artefact, Diagnosis, Evidence, Kind, Quantity
from sdt_kg.annotation import Drive
from sdt_kg.iri import body_iri
from services.embodiment.certify.asked import refused_at_once
from services.embodiment.certify.drive import STRAIGHT, rolling, turned_wheels
from services.embodiment.search.proving import Proofs
from services.embodiment.setting import Setting


@dataclass(frozen=True, slots=True)
class Hopeless:
    """Why nobody is certified, and the proof if the times alone are one."""

    diagnoses: tuple[Diagnosis, ...]
    artefact: Artefact | None
    note: str = "no robot is certified that follows the motion exactly as asked: none was searched for"


ASIDE = (
    "no body motion was searched for: a differential base is driven along x of sdt:baseBody{}; give a link "
    "that is turned that way as sdt:baseBody, or another drive"
)


def hopeless(setting: Setting, spent: Callable[[str, float], None]) -> Hopeless | None:
    """Why no search would find anything, if the motion itself or the base's wheels say so."""
    at, scene = time.perf_counter(), setting.world.scene
    aside = rolling(scene)[0]
    if setting.drive is Drive.DIFFERENTIAL and turned_wheels(aside):
        entity = body_iri(scene.robot.mechanism.name, scene.annotation.base_body)
        evidence = Evidence(Quantity.ORIENTATION_ERROR, abs(aside), STRAIGHT, "rad", entity)
        said = ASIDE.format(turned_wheels(aside))
        return Hopeless((Diagnosis(Kind.EMBODIMENT, said, evidence),), None, "none was searched for")
    findings = refused_at_once(scene, setting.container, setting.motion, setting.tolerances)
    spent("certify", at)
    if not findings.violations:
        return None
    proofs = Proofs(setting, spent)
    proofs.look(0)
    if proofs.whole is not None:
        return Hopeless((proofs.whole.diagnosis,), proofs.whole.artefact)
    return Hopeless(findings.diagnoses(), None)
