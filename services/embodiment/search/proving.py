"""Proofs that no body motion exists, as the search for one comes to look for them."""

import time
from collections.abc import Callable
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from sdt_kg.annotation import Drive
from services.embodiment.certify.tolerances import Tolerances
from services.embodiment.hold.handle import Bar
from services.embodiment.proof_check.proof.claim import Bar as ClaimedBar
from services.embodiment.proof_check.proof.content import IN_HAND
from services.embodiment.prove import Proved, Prover, claimed, in_hand, never
from services.embodiment.setting import Setting
from services.kernel import worked
from services.policy import MOST_CONTACT

Array = NDArray[np.float64]

EARLY_BOXES = 1_500  # of a proof looked for as soon as one batch of seeds reached no grasp
LATE_BOXES = 6_000  # of a proof looked for when the search has given up
SWEPT = 0.25  # [1] of the time that is left may go into it; what it takes beyond comes after the search
GIVEN_UP = 0.05  # [1] of it into a proof of holds where the base stands, before descents
GRASPS = 10.0  # [s] that may go into a proof about a set of grasps, after the search
SWEEP = 5.0  # [s] that are left for a proof that the container comes into the robot; else the search has them


class Proofs:
    """What was proved about one setting.

    Args:
        sought: Whether proofs are looked for at all.

    Attributes:
        whole: That no gripper can hold the handle all along, if one was found and verified.
        partial: The same of one hold, where the handle might be let go on the way and held anew; or of holds
            with the handle in hand, as all listed grasps have it; or of the robot's collision shapes in place
            of its bodies; or of a set of grasps.
        is_cut: Whether time ended before all was looked at that the container might come into.
    """

    def __init__(self, setting: Setting, spent: Callable[[str, float], None], *, sought: bool = True) -> None:
        self.whole: Proved | None = None
        self.partial: Proved | None = None
        self.is_cut = False
        self._setting, self._spent = setting, spent
        self._prover: Prover | None = None
        self._stands = setting.drive is Drive.FIXED
        self._swept = False  # of collision shapes, in place of its bodies
        asked = setting.tolerances
        # They refute what the usual ones accept, no more; with fingers that have to be nearer that is less.
        nearer = Tolerances.within(min(asked.contact, MOST_CONTACT), asked.friction)
        self._sought = sought and asked == nearer

    @property
    def ended(self) -> bool:
        """Whether nothing more is looked for."""
        return self.whole is not None or self.partial is not None

    def look(self, boxes: int, late: Callable[[], bool] = never) -> None:
        """Look for a proof from times, and with so many boxes for each gripper and value of the container.

        Args:
            boxes: What was looked at with as many before is not looked at again.
            late: Whether time is up; the ends of the way are looked at first.
        """
        at, setting = time.perf_counter(), self._setting
        if self.whole is not None or not self._sought:
            return
        if self._prover is None:
            self._prover = self._about()
        self.whole = self._prover.hurried(replace(setting.motion, values=self._values()))
        if self.whole is None and boxes:
            self.whole = self._prover.until(late).prove(boxes)
        self._spent("proof", at)

    def look_early(self, *, solved: bool, deadline: float) -> None:
        """Look after the first round: where no posture solved it, and what a standing robot is swept by."""
        if not solved:
            self.look(EARLY_BOXES)
        now = worked()
        if now + SWEEP < deadline:
            until = now + SWEPT * (deadline - now)
            self.look_at_sweep(lambda: worked() > until)

    def give_up(self, *, few: bool, deadline: float) -> None:
        """Look once more: with few boxes where bodies alone can stop it, shortly where descents follow."""
        now = worked()
        until = now + GIVEN_UP * (deadline - now) if self._stands else np.inf
        self.look(EARLY_BOXES if few else LATE_BOXES, lambda: worked() > until)

    def look_at_last(self, *, followed: bool, late: Callable[[], bool]) -> None:
        """Look for what the search was given the time of, no longer than early on.

        Args:
            followed: Whether a handle could be followed in hand all along.
            late: Whether time is up.
        """
        if not followed:
            self.look(LATE_BOXES, late)
        if self.is_cut:
            until = worked() + SWEEP
            self.look_at_sweep(lambda: worked() > until)

    def look_at_sweep(self, late: Callable[[], bool] = never) -> None:
        """Look whether the container would come into a robot that stands, or into its collision shapes.

        Args:
            late: Whether time is up: then it was not looked at in full, see `is_cut`.
        """
        at = time.perf_counter()
        if self._stands and self.whole is None and self._sought:
            self.whole = self._about().swept(late)
            if self.whole is None:
                self.partial = self._about(declared=True).swept(late)
                self._swept = self.partial is not None
            self.is_cut = not self.ended and late()
        self._spent("proof", at)

    def look_at_grasps(self, bar: Bar | None) -> None:
        """Look for a proof that no listed grasp, nor any between them, can be had where the base stands.

        It comes when the search is over: other holds were searched, too. It says more than a proof of one
        hold or of holds in hand, not more than one of the robot's collision shapes, which refutes every hold.
        """
        at, until = time.perf_counter(), worked() + GRASPS
        if self._stands and self._sought and bar and self.whole is None and not self._swept:
            found = self._about(bar=claimed(bar)).grasped(lambda: worked() > until)
            self.partial = found or self.partial
        self._spent("proof", at)

    def look_at_holds(self, tools: list[Array], bred: int, late: Callable[[], bool]) -> None:
        """Look for a proof that no hold, or none in hand, can be had all along, where none was found.

        Args:
            tools: Origins of the tool in listed grasps that were searched, in the handle's frame [m], (3,).
            bred: How many others were searched, of which some may not have the handle in hand.
            late: Whether time is up.
        """
        at, setting = time.perf_counter(), self._setting
        if self.whole is not None or self._prover is None:
            return
        if self._stands and not late():
            found = self._prover.prove(EARLY_BOXES, one_hold=True, late=late)
            if found is not None and found.diagnosis.proof:
                self.whole = found
            else:
                self.partial = found
        if not self.ended and tools and in_hand(setting.world, setting.container.handle, tools):
            boxes = EARLY_BOXES if self._stands else LATE_BOXES  # heights alone are cheap to compare
            found = self._about(IN_HAND).prove(boxes, self._stands and not late(), late)
            self.partial = found if found is None or not bred else _beyond(found, bred)
        self._spent("proof", at)

    def _values(self) -> Array:
        """Values of the motion, shape (T, 1); what is beyond a stop, by rounding or more, at the stop."""
        return np.clip(
            self._setting.motion.values, self._setting.container.lower, self._setting.container.upper
        )

    def _about(
        self, within: float | None = None, declared: bool = False, bar: ClaimedBar | None = None
    ) -> Prover:
        """Who looks for proofs about this setting, such holds and bodies taken so."""
        setting = self._setting
        twin, values = setting.world.scene.twin, self._values()[:, 0]
        about = setting.robot, setting.container, setting.drive, setting.start
        return Prover(twin, *about, values, within, declared, bar)


def _beyond(found: Proved, bred: int) -> Proved:
    """The same, saying what was searched beyond what it is about."""
    reason = f"{found.diagnosis.reason}; of other holds {bred} bred grasps were searched, and none will do"
    return replace(found, diagnosis=replace(found.diagnosis, reason=reason))
