"""CanPerform (Eq. 7), in process: search of a body motion, and its certificate."""

import hashlib
import time
from dataclasses import dataclass, field, replace

import numpy as np

from predicates.case import Answer, Case, Diagnosis
from predicates.meant import by_other_handles, left_parked
from predicates.record.inputs import ANY_START, NEAREST, TURNED, pose_text
from sdt_kg.annotation import Drive
from sdt_kg.errors import OracleRejectedError
from sdt_kg.iri import Iri, local_name
from sdt_kg.motion import BodyMotion, Motion
from sdt_kg.task import UNKNOWN
from sdt_kg.twin import Container, Twin
from services.embodiment.body.demands import Margins
from services.embodiment.body.warm import warm
from services.embodiment.body.world import World
from services.embodiment.certify.asked import to_keep
from services.embodiment.certify.check import Certified, Refused, certify
from services.embodiment.certify.drive import rolling
from services.embodiment.certify.tolerances import Tolerances
from services.embodiment.certify.warm import warm as warm_certifier
from services.embodiment.descent.descended import Descended
from services.embodiment.floor import check_base, check_start
from services.embodiment.handles import DRIVE, GIVEN, START, held_by, refused
from services.embodiment.hold.kit import Kits
from services.embodiment.hold.sets import grasp_settings
from services.embodiment.hopeless import hopeless
from services.embodiment.prove.tree import boxes
from services.embodiment.search.plan import Planner
from services.embodiment.search.planned import Planned, no_motion
from services.embodiment.search.report import refusal, searched
from services.embodiment.search.several import Several
from services.embodiment.setting import Setting, container_of
from services.embodiment.shapeless import of_models
from services.embodiment.ways import cells
from services.embodiment.ways.start import Start, usual
from services.embodiment.worlds import Models, Worlds
from services.kernel import worked
from services.physics.chain import of_own_joint
from services.physics.model import Scene
from services.physics.oracle import Kinematics
from services.versions import whole_body

MOVED_START = (
    "the parked robot touches the kitchen at its start pose, x {:g} m, y {:g} m: it starts {:.1f} m beside"
)
"""Said where the kitchen's start pose is not free."""


@dataclass(slots=True)
class Clock:
    """Seconds by name of a step."""

    seconds: dict[str, float] = field(default_factory=dict[str, float])

    def spent(self, step: str, since: float) -> None:
        """The time since `since` was spent in this step."""
        self.seconds[step] = self.seconds.get(step, 0.0) + time.perf_counter() - since


class WholeBody:
    """The Embodiment protocol: base, torso, one arm and its gripper; every gripper is tried.

    Args:
        drive: How the base moves; None takes the robot's own.
        start: Base pose x, y [m], yaw [rad]; None takes the kitchen's, turned to the handle
            (or the nearest that is free, for a robot that drives).
        budget: Seconds of CPU for the search of one case by one handle: on a busy machine the answer is the
            same, later.
        seed: Of the search: the same seed gives the same answer, but for the budget.
        any_start: Whether a body motion that is given may begin anywhere, in any posture.
        contact: How far a finger may be from the handle that it holds [m]; None takes the certifier's.
        friction: With which coefficient it rubs there [1]: holds that need more are refused; None: none are.
        coupled: Whether a container may be held by the handle of one that moves with it.
        regrasps: Whether it may be let go on the way, where it rests, and held anew.
        proves: Whether a proof is looked for where nothing is found, which is not in the budget.
    """

    def __init__(  # noqa: PLR0913, PLR0917  # a policy
        self,
        drive: Drive | None = None,
        start: Start | None = None,
        budget: float = 20.0,
        seed: int = 0,
        any_start: bool = False,
        contact: float | None = None,
        friction: float | None = None,
        coupled: bool = True,
        regrasps: bool = True,
        proves: bool = True,
    ) -> None:
        self.drive, self.start, self.budget, self.seed = drive, start, budget, seed
        self.any_start, self.margins, self.coupled = any_start, Margins(), coupled
        self.regrasps, self.proves = regrasps, proves
        self.tolerances = Tolerances.within(contact, friction)
        self._physics = Kinematics()
        self._compiled, self._worlds = False, Worlds(self.margins)

    @property
    def version(self) -> str:
        return whole_body()

    def settings(self, twin: Twin, robot: Iri) -> tuple[tuple[str, str], ...]:
        start = self.start or twin.kitchen().start
        drive = self._drive(twin, robot)
        usual = ("" if drive is Drive.FIXED else NEAREST) + TURNED
        told = "" if self.start else usual
        grasps = hashlib.sha256(grasp_settings().encode()).hexdigest()[:16]
        return (
            ("drive", drive.value),
            ("start", ANY_START if self.any_start else pose_text(*start) + told),
            ("tolerances", repr(self.tolerances)),
            ("margins", repr(self.margins)),
            ("grasp set", grasps),
            ("budget", f"{self.budget:g} s"),
            ("seed", str(self.seed)),
            *(() if self.coupled else (("handles", "the container's own"),)),
            *(() if self.regrasps else (("holds", "one"),)),
        )

    def prepare(self, twin: Twin, robot: Iri) -> None:
        """Models and compiled loops are loaded, also those that few questions need."""
        self.settings(twin, robot)
        world, kits, _ = self._worlds.of(twin, robot)
        self._warm(world, kits)
        cells.warm()
        boxes.warm()
        rolling(world.scene)

    def scene(self, twin: Twin, robot: Iri) -> Scene:
        """The scene in which questions about the twin are answered."""
        return self._worlds.of(twin, robot)[0].scene

    def start_pose(self, case: Case) -> Start:
        """Where the robot of a case starts."""
        if case.robot is UNKNOWN:
            raise OracleRejectedError("a start was asked for without a robot")
        _, kits, _ = self._worlds.of(case.twin, case.robot)
        return self._start(case, kits, container_of(case))

    def perform(self, case: Case) -> Answer:
        clock, began = Clock(), time.perf_counter()
        if case.robot is UNKNOWN:
            raise OracleRejectedError("CanPerform was asked without a robot")
        twin, container = case.twin, container_of(case)
        world, kits, roads = self._worlds.of(twin, case.robot)
        check_base(world.scene, self._drive(twin, case.robot))
        clock.spent("model", began)
        began = time.perf_counter()
        self._warm(world, kits)
        clock.spent("compile", began)
        models, every = (world, kits, roads), (container, *by_other_handles(twin, container))
        looked = [each for each in every if self.coupled or each.iri == container.iri]
        answers = list[Answer]()
        for held in looked:
            found = self._by_handle(case, models, held, clock)
            if found.holds:
                return replace(found, notes=(*found.notes, *held_by(container, held)))
            answers.append(found)
        return refused(twin, answers, every)

    def _by_handle(self, case: Case, models: Models, container: Container, clock: Clock) -> Answer:
        """The answer about the motion of the case, if it is that container's handle that is held."""
        world, kits, roads = models
        if isinstance(case.body_motion, BodyMotion):
            demanded = None if self.any_start else self._start(case, kits, container)
            return self._verified(case, world, container, demanded, clock)
        motion = self._as_values(case)
        if motion is None or case.robot is UNKNOWN:
            raise OracleRejectedError("CanPerform was asked without a motion")
        motion, own = of_own_joint(world.scene, container, motion), (kits, roads, self.tolerances)
        drive, start = self._drive(case.twin, case.robot), self._start(case, kits, container)
        setting = Setting(world, container, motion, drive, start, case.robot, *own, self.proves)
        return self._searched(case, setting, clock)

    def _as_values(self, case: Case) -> Motion | None:
        """The container's motion of the case as values of a joint, if it has one."""
        if isinstance(case.motion, Motion) and case.motion.is_poses:
            return self._physics.replay(case.twin, case.motion).motion
        return case.motion if isinstance(case.motion, Motion) else None

    def _searched(self, case: Case, setting: Setting, clock: Clock) -> Answer:
        none = hopeless(setting, clock.spent)
        if none is not None:
            notes = (*self._notes(setting, None), none.note)
            return Answer(case, False, none.diagnoses, notes, clock.seconds, artefact=none.artefact)
        began = worked()
        planner = Planner(setting, began + self.budget, self.seed, clock.spent)
        rejected: list[tuple[Diagnosis, ...]] = []
        for planned in planner.plans((Several, Descended) if self.regrasps else None):
            at = time.perf_counter()
            if endless := no_motion(planned.body):
                rejected.append(endless)
                continue
            outcome = self._certificate(case.twin, setting, planned.body)
            clock.spent("certify", at)
            if isinstance(outcome, Certified):
                found = replace(case, body_motion=planned.body, motion=planned.motion)
                return _certified(found, self._notes(setting, planned), clock, outcome)
            rejected.append(outcome.diagnoses)
        search = searched(planner, worked() - began)
        reasons = refusal(planner, rejected, search, self.budget)
        proof = planner.proofs.whole or planner.proofs.partial
        artefact = None if proof is None else proof.artefact
        return Answer(case, False, reasons, self._notes(setting, None), clock.seconds, artefact=artefact)

    def _verified(
        self, case: Case, world: World, container: Container, start: Start | None, clock: Clock
    ) -> Answer:
        at = time.perf_counter()
        assert isinstance(case.body_motion, BodyMotion)
        assert case.robot is not UNKNOWN
        drive = self._drive(case.twin, case.robot)
        outcome = certify(
            case.twin,
            case.robot,
            case.body_motion,
            container,
            self.tolerances,
            drive=drive,
            start=start,
            scene=world.scene,
            asked=to_keep(world.scene, self._as_values(case), case.body_motion),
            one_hold=not self.regrasps,
            in_full=True,
        )
        clock.spent("certify", at)
        notes = (DRIVE + drive.value, GIVEN, *((START + ANY_START,) if self.any_start else ()))
        notes += (*self.tolerances.notes, *of_models(world.scene, container, drive))
        parked = ", ".join(map(local_name, left_parked(case)))
        notes += (f"not listed in the motion, so parked: {parked}",) if parked else ()
        if isinstance(outcome, Certified):
            return _certified(case, notes, clock, outcome)
        notes += ("collisions are of shapes that contain the robot's: shallow ones may be theirs alone",)
        return Answer(case, False, outcome.diagnoses, notes, clock.seconds)

    def _certificate(self, twin: Twin, setting: Setting, body: BodyMotion) -> Certified | Refused:
        return certify(
            twin,
            setting.robot,
            body,
            setting.container,
            self.tolerances,
            drive=setting.drive,
            start=setting.start,
            scene=setting.world.scene,
            asked=setting.motion if setting.motion.timed else None,
            one_hold=not self.regrasps,
        )

    def _notes(self, setting: Setting, planned: Planned | None) -> tuple[str, ...]:
        x, y, yaw = setting.start
        notes = [
            DRIVE + setting.drive.value,
            f"{START}x {x:.3f} m, y {y:.3f} m, yaw {yaw:.3f} rad, parked",
        ]
        usual = setting.world.scene.twin.kitchen().start
        if self.start is None and usual[:2] != (x, y):
            notes.append(MOVED_START.format(usual[0], usual[1], np.hypot(x - usual[0], y - usual[1])))
        if planned is not None:
            gripper = planned.assembler.limb.gripper.name
            notes.append(f"grasp {planned.grasp} by gripper {gripper}, {planned.style}")
        return (
            *notes,
            *self.tolerances.notes,
            *of_models(setting.world.scene, setting.container, setting.drive),
        )

    def _drive(self, twin: Twin, robot: Iri) -> Drive:
        return self.drive or twin.robot(robot).drive

    def _start(self, case: Case, kits: Kits, container: Container) -> Start:
        """Where the robot starts: as told, else as usual.

        Raises:
            InputError: There is no floor.
        """
        assert case.robot is not UNKNOWN
        check_start(self.start or case.twin.kitchen().start)
        if self.start is not None:
            return self.start
        return usual(kits, container, self._drive(case.twin, case.robot))

    def _warm(self, world: World, kits: Kits) -> None:
        """Compilation costs no budget."""
        if not self._compiled:
            warm(world, kits.of(world.scene.annotation.grippers[0]).limb)
            warm_certifier(world.scene)
            self._compiled = True


def _certified(case: Case, notes: tuple[str, ...], clock: Clock, outcome: Certified) -> Answer:
    """CanPerform holds, with what re-verifies it."""
    said, found = (*notes, *outcome.nearest), (outcome.artefact(), outcome.nearest_pairs)
    return Answer(case, True, (), said, clock.seconds, outcome.figures, *found)
