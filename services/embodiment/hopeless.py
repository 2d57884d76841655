"""Motions of a container for which no robot need be searched: nobody is certified to move it so."""

import time
from collections.abc import Callable
from dataclasses import dataclass

from predicates.case import Artefact, Diagnosis
from services.embodiment.certify.asked import refused_at_once
from services.embodiment.proving import Proofs
from services.embodiment.setting import Setting


@dataclass(frozen=True, slots=True)
class Hopeless:
    """Why nobody is certified, and the proof if the times alone are one."""

    diagnoses: tuple[Diagnosis, ...]
    artefact: Artefact | None
    note: str = "the motion that is asked for is certified with no robot: none was searched for"


def hopeless(setting: Setting, spent: Callable[[str, float], None]) -> Hopeless | None:
    """Why no search would find anything, if the motion itself says so."""
    at, scene = time.perf_counter(), setting.world.scene
    findings = refused_at_once(scene, setting.container, setting.motion, setting.tolerances)
    spent("certify", at)
    if not findings.violations:
        return None
    proofs = Proofs(setting, spent)
    proofs.look(0)
    if proofs.whole is not None:
        return Hopeless((proofs.whole.diagnosis,), proofs.whole.artefact)
    return Hopeless(findings.diagnoses(), None)
