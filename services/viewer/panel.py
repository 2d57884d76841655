"""What one person can choose and read beside the scene; nothing here knows what it is for."""

import math
from collections.abc import Callable, Sequence
from typing import Any, Final

import viser

from services.policy import MOST_FRICTION
from services.viewer.words import nothing_yet, status

Tell = Callable[[str], None]
Control = Any  # viser's handles have no common type

KITCHENS_START: Final = "kitchen's start, turned to the handle"
OWN_START: Final = "as set below"
OWN_DRIVE: Final = "as its hardware"
WHOLE: Final = "the whole motion"
MOTIONS: Final = ".npz,.json,.csv,.mcap"
SPEEDS: Final = ("1x", "2x", "4x", "8x")
WIDTH: Final = 320
"""[px] Of each of the two panels."""


class Panel:
    """The controls, each told of by its name when the person moves it.

    Args:
        gui: Of one person.
        choices: Name of a drop-down → what it offers: kitchen, robot, drive, tee.
        tell: Called with a control's name.
        budget: Of a search [s].
    """

    def __init__(
        self, gui: viser.GuiApi, choices: dict[str, Sequence[str]], tell: Tell, budget: float
    ) -> None:
        self._gui, self._tell = gui, tell
        tabs = gui.add_tab_group()
        with tabs.add_tab("Ask"):
            self._ask(choices, budget)
        with tabs.add_tab("What if"):
            self._what_if()
        with tabs.add_tab("Files"):
            self.files = gui.add_folder("Open a file")
            self._files()
        with tabs.add_tab("Show"):
            self._show()
        gui.main_panel.dock_right()
        gui.main_panel.set_width(WIDTH)
        self._answer()

    def _on(self, name: str, control: Control) -> Control:
        async def tell(event: viser.GuiEvent) -> None:
            if event.client_id is not None:
                self._tell(name)

        if isinstance(control, viser.GuiButtonHandle):
            control.on_click(tell)
        elif isinstance(control, viser.GuiUploadButtonHandle):
            control.on_upload(tell)
        else:
            control.on_update(tell)
        return control

    def _ask(self, choices: dict[str, Sequence[str]], budget: float) -> None:
        gui = self._gui
        self.kitchen = self._on("kitchen", gui.add_dropdown("Kitchen", tuple(choices["kitchen"])))
        self.robot = self._on("robot", gui.add_dropdown("Robot", tuple(choices["robot"])))
        self.verb = self._on("question", gui.add_dropdown("Request", ("open", "close")))
        self.container = self._on("question", gui.add_dropdown("Container", ("",)))
        drives = (OWN_DRIVE, *choices["drive"])
        self.drive = self._on("question", gui.add_dropdown("Drive", drives, hint="how the base moves"))
        starts = (KITCHENS_START, OWN_START)
        self.start = self._on("start", gui.add_dropdown("Base pose", starts))
        self.base = self._on(
            "base", gui.add_vector3("x, y, yaw", (0.0, 0.0, 0.0), step=0.05, hint="m, m, rad", visible=False)
        )
        self.tee = self._on("question", gui.add_dropdown("TEE class", tuple(choices["tee"])))
        self.budget = self._on(
            "question",
            gui.add_number("Search [s]", budget, min=0.5, max=600.0, step=0.5, hint="then it gives up"),
        )
        self.check = self._on("check", gui.add_button("Check", color=(20, 96, 42)))
        self.stop = self._on("stop", gui.add_button("Stop", visible=False))
        self.progress = gui.add_progress_bar(0.0, visible=False)
        self._status = gui.add_html(status("Loading …"))

    def _what_if(self) -> None:
        gui = self._gui
        self.follow = gui.add_checkbox("Verdict follows", True, hint="judge again after every change")
        with gui.add_folder("A door or drawer"):
            self.door = self._on("door", gui.add_dropdown("Which", ("",)))
            self.opened = self._on("opened", gui.add_slider("Position", 0.0, 1.0, 0.01, 0.0))
            self.closed = self._on("closed", gui.add_button("Close all"))
        with gui.add_folder("An obstacle"):
            self.obstacle = self._on("obstacle", gui.add_checkbox("A box stands there", False))
            self.size = self._on(
                "obstacle", gui.add_vector3("Size [m]", (0.4, 0.4, 0.9), min=(0.02, 0.02, 0.02), step=0.05)
            )
            self.above = self._on(
                "obstacle", gui.add_number("Above floor [m]", 0.0, min=0.0, max=3.0, step=0.05)
            )
        with gui.add_folder("The fingers"):
            told = "holds that need more are refused; 0: the verdict says what they need"
            friction = gui.add_number("Friction", 0.0, min=0.0, max=MOST_FRICTION, step=0.05, hint=told)
            self.friction = self._on("question", friction)
        with gui.add_folder("The base"):
            self.gizmo = self._on("gizmo", gui.add_checkbox("Move it in the scene", False))

    def _files(self) -> None:
        with self.files:
            self.any_start = self._on("question", self._gui.add_checkbox("It may begin anywhere", False))
            self.drop = self._on("drop", self._gui.add_button("Leave the motion", visible=False))
        self._uploads()

    def _uploads(self) -> None:
        gui = self._gui
        with self.files:
            motion = gui.add_upload_button("A motion", mime_type=MOTIONS, order=-2)
            model = gui.add_upload_button("A kitchen (.urdf)", mime_type=".urdf", order=-1)
        self.motion, self.model = self._on("motion", motion), self._on("model", model)

    def refresh_uploads(self) -> None:
        """Buttons for files that are new to the browser: one whose file was refused would wait for ever."""
        self.motion.remove()
        self.model.remove()
        self._uploads()

    def _show(self) -> None:
        gui = self._gui
        self.collision = self._on("show", gui.add_checkbox("Collision geometry", True, hint="what is judged"))
        self.visual = self._on(
            "show", gui.add_checkbox("Visual geometry", False, hint="where the URDF has it")
        )
        self.paths = self._on("show", gui.add_checkbox("Handle paths", True))
        self.pointed = self._on("show", gui.add_checkbox("Marks and ghost", True))
        self.link = gui.add_markdown("")
        self.save = self._on("save", gui.add_button("Save the verdict (.trig)", disabled=True))

    def _answer(self) -> None:
        gui = self._gui
        answer = gui.add_panel()
        with answer.add_tab("Verdict"):
            self.verdict = gui.add_html(nothing_yet())
            self.phase = gui.add_markdown("", visible=False)
            self.time = self._on("time", gui.add_slider("Time [s]", 0.0, 1.0, 0.01, 0.0, visible=False))
            self.play = self._on("play", gui.add_button("Play", visible=False))
            self.speed = gui.add_dropdown("Speed", SPEEDS, initial_value="4x", visible=False)
            self.look = self._on("look", gui.add_dropdown("Look at", (WHOLE,), visible=False))
            self.story = gui.add_html("")
        answer.dock_left()
        answer.set_width(WIDTH)

    def say(self, text: str, *, trouble: bool = False) -> None:
        """What goes on, or what cannot be done."""
        self._status.content = status(text, trouble=trouble)

    def offer(self, control: Control, options: Sequence[str], chosen: str | None = None) -> None:
        """A drop-down offers these; chosen is that one, else the same as before, else the first."""
        before = control.value
        if tuple(control.options) != tuple(options):
            control.options = tuple(options)
        wanted = chosen if chosen in options else before if before in options else options[0]
        if control.value != wanted:
            control.value = wanted

    def show_film(self, duration: float | None) -> None:
        """The timeline is there for a motion of that many seconds; None: nothing to play."""
        there = duration is not None
        for control in (self.phase, self.time, self.play, self.speed):
            control.visible = there
        if duration is not None:
            self.time.value = 0.0
            self.time.max = max(math.ceil(100 * duration) / 100, 0.01)
