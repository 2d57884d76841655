"""What the drive can do: the base stands, or rolls ahead; exact between samples."""

from dataclasses import replace
from functools import lru_cache

import numpy as np

from predicates.case import Evidence, Quantity
from sdt_kg.annotation import Drive
from services.embodiment.certify.findings import Findings, Violation
from services.embodiment.certify.limits import STILL, first_and_worst
from services.embodiment.certify.sweep.pieces import Pieces, positions, sideways
from services.embodiment.certify.tolerances import Tolerances
from services.physics.model import Scene

SIDEWAYS, DRIFT = "sideways velocity", "sideways path"
"""Names of figures of a base on wheels that roll ahead."""
FINER = 32  # what is not looked at is less than this part of the sideways velocity, or path, that is allowed
STRAIGHT = 0.01  # [rad] wheels that roll so near to x of the base roll along it: see Tolerances.sideways


def drive_limits(scene: Scene, pieces: Pieces, drive: Drive, tolerances: Tolerances) -> Findings:
    """The base moves only as its drive can."""
    if drive is Drive.OMNI:
        return Findings()
    base = pieces.columns(scene.base)
    return _stands(scene, base) if drive is Drive.FIXED else _rolls(scene, base, tolerances)


@lru_cache(maxsize=8)
def rolling(scene: Scene) -> tuple[float, float]:
    """Where its wheels roll, from x of the base [rad], and how far that way they turn about one line [m]."""
    from sdt_kg.describe.wheels import rolling_of  # noqa: PLC0415 - only what rolls asks for it

    return rolling_of(scene.robot.mechanism, scene.annotation)


def _stands(scene: Scene, base: Pieces) -> Findings:
    findings, (values, s) = Findings(), positions(base)
    moved = np.abs(values - base.c[0, 0])
    for k, i, n in first_and_worst(moved > STILL, moved):
        unit = "rad" if k == 2 else "m"
        value, time = float(moved[i, n, k]), float(base.start[n] + s[i, n, k])
        evidence = Evidence(Quantity.POSITION, value, 0.0, unit, scene.names[scene.base[k]], time=time)
        reason = f"the base moves by {value:.4g} {unit}, and it is fixed"
        findings.violations.append(Violation("fixed base", reason, evidence, value))
    return findings


def turned_wheels(heading: float) -> str:
    """That wheels roll elsewhere than along x of the base body, in words; empty if they do."""
    if abs(heading) < STRAIGHT:
        return ""
    return f", and its wheels roll at {abs(np.degrees(heading)):.3g}° to x of sdt:baseBody"


def _rolls(scene: Scene, base: Pieces, tolerances: Tolerances) -> Findings:
    """Its wheels roll ahead: the point amid them hardly moves sideways, neither at once nor in all."""
    heading, axle = rolling(scene)
    along = replace(base, c=base.c + np.array([0.0, 0.0, heading]) * (np.arange(4) == 0)[:, None, None])
    most, times, drift = sideways(along, axle, tolerances.sideways / FINER)
    if drift > tolerances.drift and most.max() <= tolerances.sideways:
        rolls = base.duration[base.c[1:].any(axis=(0, 2))].sum()
        _, _, drift = sideways(along, axle, 2 * tolerances.drift / (FINER * rolls))
    findings = Findings(figures={SIDEWAYS: (float(most.max()), "m/s"), DRIFT: (drift, "m")})
    entity = scene.names[scene.base[0]]
    side = "before" if axle > 0 else "behind"
    where = "" if axle == 0 else f": its wheels turn about a line {abs(axle):.3f} m {side} sdt:baseBody"
    where = turned_wheels(heading) + where
    for n in {int(np.argmax(most > tolerances.sideways)), int(np.argmax(most))}:
        if most[n] > tolerances.sideways:
            value, time = float(most[n]), float(times[n])
            evidence = Evidence(
                Quantity.SIDEWAYS_VELOCITY, value, tolerances.sideways, "m/s", entity, time=time
            )
            reason = f"the base moves sideways at {value:.4g} m/s, and its drive is differential{where}"
            findings.violations.append(Violation("sideways motion", reason, evidence, value))
    if drift > tolerances.drift:
        evidence = Evidence(Quantity.POSITION, drift, tolerances.drift, "m", entity)
        reason = f"the base drifts up to {drift:.4g} m sideways in all, and its drive is differential{where}"
        findings.violations.append(Violation("sideways drift", reason, evidence, drift))
    return findings
