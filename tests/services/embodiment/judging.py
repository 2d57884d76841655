"""The certifier's verdict on motions of the gantry, and what tests ask of a refusal."""

import numpy as np

from predicates.case import Diagnosis, Kind, Quantity
from sdt_kg.annotation import Drive
from sdt_kg.motion import BodyMotion, Motion
from sdt_kg.twin import Twin
from services.embodiment.certify import Certified, Refused, Tolerances, certify
from tests.services.embodiment.gantry import RESTS, START


def judge(
    twin: Twin,
    motion: BodyMotion,
    drive: Drive = Drive.OMNI,
    start: tuple[float, float, float] | None = START,
    tolerances: Tolerances | None = None,
) -> Certified | Refused:
    container = twin.container("drawer_main")
    return certify(
        twin, twin.robots[0], motion, container, tolerances or Tolerances(), drive=drive, start=start
    )


def reasons(twin: Twin, motion: BodyMotion, **more: bool | Motion) -> str:
    """Why it is refused."""
    found = certify(
        twin,
        twin.robots[0],
        motion,
        twin.container("drawer_main"),
        Tolerances(),
        drive=Drive.OMNI,
        start=START,
        **more,  # type: ignore[arg-type]
    )
    assert isinstance(found, Refused)
    return " | ".join(one.reason for one in found.diagnoses)


def refusal(
    twin: Twin,
    motion: BodyMotion,
    quantity: Quantity,
    drive: Drive = Drive.OMNI,
    start: tuple[float, float, float] | None = START,
) -> list[Diagnosis]:
    """The diagnoses of that quantity; there is at least one, and none claims a proof."""
    verdict = judge(twin, motion, drive, start)
    assert isinstance(verdict, Refused)
    assert all(one.kind is Kind.EMBODIMENT and not one.proof for one in verdict.diagnoses)
    found = [one for one in verdict.diagnoses if one.evidence and one.evidence.quantity is quantity]
    assert found, [one.reason for one in verdict.diagnoses]
    return found


def only(twin: Twin, motion: BodyMotion, quantity: Quantity, drive: Drive = Drive.OMNI) -> list[Diagnosis]:
    """As `refusal`, and there is no reason but that one."""
    verdict = judge(twin, motion, drive)
    found = refusal(twin, motion, quantity, drive)
    assert isinstance(verdict, Refused)
    assert list(verdict.diagnoses) == found, [one.reason for one in verdict.diagnoses]
    return found


def with_rests(**columns: tuple[int, float]) -> np.ndarray:
    """RESTS with values replaced: name of a column → (row, value)."""
    names = ("time", "x", "y", "yaw", "lift", "arm", "wrist", "finger", "drawer")
    rests = RESTS.copy()
    for name, (row, value) in columns.items():
        rests[row, names.index(name)] = value
    return rests
