"""One random front, asked of one robot under one base policy: certified, proved, proved in part or open."""

import os
from collections import Counter
from enum import Enum
from pathlib import Path

import numpy as np

from predicates.case import ArtefactKind, Outcome
from sdt_kg.annotation import Drive
from services.app import Policy, Service, load
from services.embodiment.certify.held.holds import HOLDS
from services.embodiment.proof_check import check
from services.embodiment.proof_check.proof.content import IN_HAND
from services.embodiment.proof_check.proof.written import read_proof
from services.embodiment.prove import Prover
from tests.soak.doors import draw, write

ROBOTS = tuple(os.environ.get("SDT_DOORS_ROBOTS", "pr2,tiago_dual,stretch").split(","))
POLICIES = (Drive.FIXED, Drive.OMNI)
STANDS = (0.0, 0.0, 0.0)
BOXES = 6_000  # of a proof that is looked for against a certificate


class Result(Enum):
    """What is known of one front; never two of them.

    ONE_HOLD: that one hold lasts is refuted, not that it is let go on the way and held anew.
    IN_HAND: every hold with the handle in hand is refuted, as all that are listed have it; not every other.
    OF_GRASPS: every grasp across the bar is, with a fixed base.
    OF_SHAPES: every one is, with the robot's collision shapes for its bodies.
    """

    CERTIFIED = "certified"
    PROVED = "proved"
    ONE_HOLD = "proved of one hold"
    IN_HAND = "proved of holds in hand"
    OF_GRASPS = "proved of the grasp set"
    OF_SHAPES = "proved of collision shapes"
    OPEN = "open"


def result(  # noqa: PLR0917  # a front, who is asked, and for how long
    folder: Path,
    seed: int,
    robot: str,
    drive: Drive,
    budget: float,
    one_hold: bool = False,
    refutes: bool = True,
) -> Result:
    """The oracle's answer, which a proof must not contradict and a checked proof must carry.

    Args:
        folder: For the front's URDF.
        seed: Number of the front.
        robot: That is asked.
        drive: Its base policy.
        budget: Of search [s].
        one_hold: Whether proofs that no one hold lasts are looked for against certificates too, at length.
        refutes: Whether any are: that takes longer than most certificates.
    """
    front = draw(np.random.default_rng(seed))
    path = write(front, folder, f"front{seed}")
    service = load(path, [robot], policy=Policy(drive, STANDS, budget))
    (verdict,) = service.achieve("open:front_door")
    if verdict.outcome is Outcome.CERTIFIED:
        assert verdict.can_perform is not None
        one_hold &= HOLDS not in verdict.can_perform.figures
        assert not (refutes and refutable(service, drive, one_hold)), (
            f"front {seed} is certified for {robot}, and refuted"
        )
        return Result.CERTIFIED
    proved = any(each.proof for each in verdict.diagnoses)
    assert verdict.can_perform is not None, f"front {seed} is refuted, and not by CanPerform"
    artefact = verdict.can_perform.artefact
    if artefact is None:
        assert not proved, f"front {seed} is proved, and nothing shows it"
        return Result.OPEN
    assert artefact.kind is ArtefactKind.PROOF
    twin = service.twin
    checked = check(twin, twin.robots[0], twin.container("front_door"), artefact.content)
    assert checked.holds, checked.reasons
    if proved:
        return Result.PROVED
    claim = read_proof(artefact.content).claim
    if claim.declared:
        return Result.OF_SHAPES
    if claim.bar is not None:
        return Result.OF_GRASPS
    return Result.ONE_HOLD if claim.within is None else Result.IN_HAND


def refutable(service: Service, drive: Drive, one_hold: bool) -> bool:
    """Whether a proof is found against a certified front, or the hold that it was certified with."""
    twin = service.twin
    container = twin.container("front_door")
    values = np.array([0.0, container.open_from])
    about = twin, twin.robots[0], container, drive, STANDS, values
    if drive is Drive.FIXED and Prover(*about, declared=True).swept() is not None:
        return True
    return any(Prover(*about, within).prove(BOXES, one_hold) is not None for within in (None, IN_HAND))


def summary(robot: str, drive: Drive, results: list[Result]) -> str:
    """Counts apart, and which fronts are neither certified nor proved of every hold."""
    counts, others = Counter(results), dict[Result, list[int]]()
    for seed, one in enumerate(results):
        if one not in {Result.CERTIFIED, Result.PROVED}:
            others.setdefault(one, []).append(seed)
    told = ", ".join(f"{counts[one]} {one.value}" for one in Result)
    which = "".join(f"\n  {one.value}: {', '.join(map(str, seeds))}" for one, seeds in others.items())
    return f"{robot}, {drive.value}: {len(results)} fronts, {told}{which}"
