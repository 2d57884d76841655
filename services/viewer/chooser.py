"""What one person chooses: the controls and gizmos read into a choice, and set again after it."""

import copy
from collections.abc import Callable, Sequence
from dataclasses import replace

import viser

from sdt_kg.annotation import Drive
from sdt_kg.errors import InputError, SdtError, UnknownEntityError
from sdt_kg.load import model_name
from sdt_kg.twin import Container, Twin
from services.requests import listed_states, parse_base, parse_friction, parse_state, parse_task
from services.viewer.choice import Choice, Obstacle, free_name
from services.viewer.desk import CLASSES, Desk
from services.viewer.judging.question import Place
from services.viewer.panel import KITCHENS_START, OWN_DRIVE, OWN_START, Panel
from services.viewer.picture.standing import Pose2, start_pose
from services.viewer.scene.gizmos import Gizmos
from services.viewer.showing import Showing

BESIDE = 1.0
"""[m] In front of the robot's start an obstacle is put first."""


class Chooser:
    """Controls, gizmos and the choice that they make up.

    Attributes:
        choice: What is chosen.
        kitchens: Name → source: those on offer, and the person's own.
    """

    def __init__(
        self,
        client: viser.ClientHandle,
        desk: Desk,
        panel: Panel,
        showing: Showing,
        tell: Callable[[str], None],
    ) -> None:
        self._desk, self._panel, self._showing = desk, panel, showing
        self._gizmos = Gizmos(client.scene, tell)
        self.kitchens, self.robots = dict(desk.kitchens), dict(desk.robots)
        self.choice = Choice(
            next(iter(self.kitchens.values())),
            next(iter(self.robots.values())),
            budget=desk.budget,
            friction=desk.friction,
        )
        self._known_paths: Place | None = None

    @property
    def twin(self) -> Twin:
        """Kitchen and robot in the chosen state, without the obstacle."""
        return self._desk.twin(self.choice.place(edited=False))

    def take(self, wanted: dict[str, str]) -> None:
        """The case that a link names.

        Raises:
            InputError: It names what there is not; what it names before that is taken.
        """
        self.choice.kitchen = _offered(self.kitchens, wanted.get("kitchen"), "kitchen") or self.choice.kitchen
        self.choice.robot = _offered(self.robots, wanted.get("robot"), "robot") or self.choice.robot
        if "state" in wanted:
            before = self.twin
            state = parse_state(before, listed_states(wanted["state"]))
            moved = {each for each in state if state[each] != before.state[each]}
            self.choice.opened = {
                each.name: state[each.active_joint]
                for each in before.containers()
                if each.active_joint in moved
            }
        if "task" in wanted:
            task = parse_task(self.twin, wanted["task"])
            self.choice.verb = task.verb.value
            if isinstance(task.container, str):
                self.choice.container = self.twin.container(task.container).name
        if "tee" in wanted:
            self.choice.tee = _one_of(CLASSES, "TEE class", wanted["tee"])
        if "drive" in wanted:
            self.choice.drive = _one_of([each.value for each in Drive], "drive", wanted["drive"])
        self.choice.base = parse_base(wanted.get("base"))
        if "friction" in wanted:
            self.choice.friction = parse_friction(wanted["friction"])

    def show(self) -> None:
        """Controls and scene are as the choice says.

        Raises:
            InputError: A model that is none.
        """
        choice, panel, twin = self.choice, self._panel, self.twin
        if choice.obstacle is not None:
            choice.obstacle = replace(choice.obstacle, name=free_name(twin))
        names = [each.name for each in twin.containers()]
        if not names:
            raise InputError(
                f"kitchen '{twin.name(twin.environment)}' has no container",
                allowed="a kitchen with doors or drawers that have handles",
                remedy="sdt containers KITCHEN --all says what is left out, and why",
            )
        panel.offer(panel.kitchen, list(self.kitchens), _name(self.kitchens, choice.kitchen))
        panel.offer(panel.robot, list(self.robots), _name(self.robots, choice.robot))
        panel.offer(panel.verb, ("open", "close"), choice.verb)
        panel.offer(panel.container, names, choice.container or None)
        panel.offer(panel.door, names, choice.container or None)
        panel.offer(panel.tee, CLASSES, choice.tee)
        panel.offer(panel.drive, list(panel.drive.options), choice.drive or OWN_DRIVE)
        panel.friction.value = choice.friction or 0.0
        choice.container = panel.container.value
        self._door()
        self._scene()

    def _scene(self) -> None:
        choice, panel, twin = self.choice, self._panel, self.twin
        kitchen, robot = self._desk.kitchen(twin, choice.kitchen), self._desk.robot(twin, choice.robot)
        container = twin.container(choice.container)
        start = start_pose(twin, kitchen.skeleton, container, choice.base)
        panel.base.visible = choice.base is not None
        panel.offer(
            panel.start, list(panel.start.options), KITCHENS_START if choice.base is None else OWN_START
        )
        panel.base.value = start
        self._gizmos.base(start if panel.gizmo.value else None)
        self._gizmos.box(choice.obstacle)
        self._showing.world(twin, (kitchen, robot), start, container)

    def _door(self) -> None:
        """The slider is that of the chosen door."""
        container = self.twin.container(self._panel.door.value)
        low, high = _range(container)
        slider = self._panel.opened
        now = self.choice.opened.get(container.name, self.twin.state[container.active_joint])
        slider.min, slider.max = min(low, slider.value), max(high, slider.value)
        slider.value = min(max(now, low), high)
        slider.min, slider.max, slider.step = low, high, (high - low) / 100

    def changed(self, name: str) -> bool:
        """Whether what a person moved makes it another question; if it is none, all is as it was.

        Raises:
            InputError: A model, state or pose that is none.
        """
        if name == "door":
            self._door()
            return False
        if name == "gizmo":
            self._scene()
            return False
        before = copy.deepcopy(self.choice)
        try:
            self._read(name)
            if self.choice == before:
                return False
            self.show()
        except SdtError:
            self.choice = before
            self.show()
            raise
        return True

    def use(self, *, kitchen: str = "", motion: str | None = None) -> None:
        """A file of the person's own is chosen.

        Raises:
            InputError: It is no model; what was chosen before stays.
        """
        before, known = copy.deepcopy(self.choice), dict(self.kitchens)
        if motion is not None:
            self.choice.motion = motion
        if kitchen:
            self.kitchens[model_name(kitchen)] = kitchen
            self._other_kitchen(kitchen)
        try:
            self.show()
        except SdtError:
            self.choice, self.kitchens = before, known
            self.show()
            raise

    def needs_paths(self) -> bool:
        """Whether what can be opened from here is not asked for yet."""
        place = self.choice.place()
        needed = self._known_paths is None or place != self._known_paths
        self._known_paths = place
        return needed

    def _other_kitchen(self, source: str) -> None:
        choice = self.choice
        choice.kitchen, choice.opened, choice.container, choice.motion = source, {}, "", ""

    def _read(self, name: str) -> None:
        panel, choice = self._panel, self.choice
        kitchen = self.kitchens[panel.kitchen.value]
        if kitchen != choice.kitchen:
            self._other_kitchen(kitchen)
            return
        choice.robot = self.robots[panel.robot.value]
        choice.verb, choice.container, choice.tee = panel.verb.value, panel.container.value, panel.tee.value
        choice.drive = None if panel.drive.value == OWN_DRIVE else panel.drive.value
        choice.budget, choice.any_start = float(panel.budget.value), panel.any_start.value
        choice.friction = float(panel.friction.value) or None
        if name in {"start", "base", "base dragged"}:
            choice.base = self._base(name)
        if name in {"obstacle", "box dragged"}:
            choice.obstacle = self._obstacle(name)
        if name == "opened":
            container = self.twin.container(panel.door.value)
            choice.opened = {**choice.opened, container.name: float(panel.opened.value)}
        if name == "closed":
            choice.opened = {}
        if name == "drop":
            choice.motion = ""

    def _base(self, name: str) -> Pose2 | None:
        if name == "base dragged":
            return self._gizmos.base_pose()
        if name == "start" and self._panel.start.value == KITCHENS_START:
            return None
        return parse_base(",".join(map(repr, map(float, self._panel.base.value))))

    def _obstacle(self, name: str) -> Obstacle | None:
        if not self._panel.obstacle.value:
            return None
        if name == "box dragged":
            x, y, yaw = self._gizmos.box_pose()
        elif self.choice.obstacle is not None:
            x, y, yaw = self.choice.obstacle.x, self.choice.obstacle.y, self.choice.obstacle.yaw
        else:
            start = self.twin.kitchen().start
            x, y, yaw = start[0] + BESIDE, start[1], 0.0
        a, b, c = map(float, self._panel.size.value)
        return Obstacle((a, b, c), x, y, yaw, float(self._panel.above.value), free_name(self.twin))


def _range(container: Container) -> tuple[float, float]:
    """Positions of the actuated joint at which the container is closed and open [rad or m]."""
    low, high = sorted(
        (each - container.offset) / container.multiplier for each in (container.lower, container.upper)
    )
    return low, high


def _offered(sources: dict[str, str], wanted: str | None, kind: str) -> str | None:
    """The source of a name that a link says: never a path, a link may not choose what is read."""
    if wanted is None:
        return None
    if wanted not in sources:
        raise UnknownEntityError(kind, wanted, sources, f"sdt view --{kind} NAME offers it")
    return sources[wanted]


def _one_of(names: Sequence[str], kind: str, wanted: str) -> str:
    if wanted not in names:
        raise InputError(f"no {kind} '{wanted}'", allowed=", ".join(names))
    return wanted


def _name(sources: dict[str, str], source: str) -> str:
    return next(name for name, each in sources.items() if each == source)
