"""One person at the page: what was chosen and is to be judged. One thread does one thing at a time."""

import logging
import queue
import tempfile
import threading
import time
from collections.abc import Callable
from pathlib import Path
from typing import Final

import viser

from sdt_kg.annotation import Drive
from sdt_kg.errors import InputError, SdtError
from services.judging.problems import Problem
from services.store.output import writing
from services.viewer.chooser import Chooser
from services.viewer.desk import CLASSES, Desk
from services.viewer.doors.uploads import bounded, hide_progress
from services.viewer.judging.judges import Ticket
from services.viewer.judging.question import Answered, Asked, Judged, Paths, PathsAsked
from services.viewer.panel import Panel
from services.viewer.showing import Showing

FRAME: Final = 1 / 20
"""[s] Between two pictures of a film."""
TICK: Final = 0.25
"""[s] Between two looks at the clock while something is waited for."""
SETTLE: Final = 0.4
"""[s] After the last change before the verdict follows."""
OWN: Final = "-own"
"""Ends the name of a kitchen of one's own that is called as what is on offer: both can be told apart."""
OVER: Final = "leave"
WAITING: Final = "Waiting: the judge is busy with what was asked before."
GETTING_READY: Final = "Waiting: the judge gets ready (after an installation it compiles, for a minute)."

_log = logging.getLogger("sdt.view")


class Session(threading.Thread):
    """What one person sees and does; ends when they leave."""

    def __init__(self, client: viser.ClientHandle, desk: Desk, wanted: dict[str, str]) -> None:
        super().__init__(daemon=True, name=f"sdt-view-{client.client_id}")
        self._client, self._desk, self._wanted = client, desk, wanted
        self._gone = threading.Event()
        self._line: queue.SimpleQueue[str] = queue.SimpleQueue()
        self._due_names: set[str] = set()
        self._lock = threading.Lock()
        self._answers: queue.SimpleQueue[tuple[Asked, Answered]] = queue.SimpleQueue()
        self._ticket: Ticket | None = None
        self._paths: Ticket | None = None
        self._follow_at: float | None = None
        self._folder = tempfile.TemporaryDirectory(prefix="sdt-view-")
        self._refused: list[tuple[float, str]] = []
        self._why, self._files = "", 0

    def tell(self, name: str) -> None:
        """Something was done; the same thing twice before it was looked at is once."""
        with self._lock:
            if name in self._due_names:
                return
            self._due_names.add(name)
        self._line.put(name)

    def leave(self) -> None:
        """The person is gone."""
        self._gone.set()
        self.tell(OVER)

    def run(self) -> None:
        with self._client.atomic():  # one picture, not one for each control
            self._safely(self._open)
        last = time.monotonic()
        while True:
            ran = self._showing.film.playing
            try:
                name = self._line.get(timeout=self._pause())
            except queue.Empty:
                name = ""
            with self._lock:
                self._due_names.discard(name)
            if name == OVER:
                break
            now = time.monotonic()
            since, last = now - last if ran else 0.0, now
            if name:
                self._safely(lambda done=name: self._do(done))
            self._safely(lambda passed=since: self._tick(passed))
        for ticket in (self._ticket, self._paths):
            if ticket is not None:
                ticket.give_up()
        self._folder.cleanup()

    def _pause(self) -> float | None:
        if self._showing.film.playing:
            return FRAME
        waits = self._ticket is not None or self._follow_at is not None or self._refused
        return TICK if waits else None

    def _safely(self, act: Callable[[], None]) -> None:
        """The page lives on, whatever happens; what was wrong with the input is said as on the shell."""
        if self._gone.is_set():
            return
        try:
            act()
        except SdtError as error:
            self._trouble(str(error))
        except Exception:  # noqa: BLE001 - the edge of the service: logged, and said
            _log.exception("the page could not do what was asked")
            self._trouble("the page could not do that; the log of the service says why")

    def _trouble(self, text: str) -> None:
        self._panel.say(text, trouble=True)
        self._client.add_notification("This cannot be done", text, color=(161, 18, 18), auto_close_seconds=30)

    def _open(self) -> None:
        """Controls and scene are there, on the case that a link named."""
        desk, gui = self._desk, self._client.gui
        choices = {
            "kitchen": list(desk.kitchens),
            "robot": list(desk.robots),
            "drive": [each.value for each in Drive],
            "tee": CLASSES,
        }
        self._panel = Panel(gui, choices, self.tell, desk.budget)
        self._showing = Showing(self._client, self._panel)
        self._chooser = Chooser(self._client, desk, self._panel, self._showing, self.tell)
        bounded(self._client, self._refuse)
        try:
            self._chooser.take(self._wanted)
        finally:
            self._chooser.show()
            self._moved()
        self._panel.say("Ready. Choose, then Check.")

    def _do(self, name: str) -> None:
        acts: dict[str, Callable[[], None]] = {
            "check": self._check,
            "stop": self._stop,
            "time": self._showing.scrub,
            "play": self._showing.play,
            "look": self._showing.look,
            "show": self._showing.seen,
            "save": self._save,
            "motion": self._motion,
            "model": self._model,
            "answer": self._answered,
            "refused": self._refusal,
        }
        if name in acts:
            acts[name]()
        elif self._chooser.changed(name):
            self._moved()

    def _moved(self) -> None:
        """Something that the verdict is about is another."""
        self._give_up()
        self._panel.link.content = f"[Link to this case]({self._chooser.choice.link()})"
        self._panel.drop.visible = bool(self._chooser.choice.motion)
        self._showing.outdated()
        if self._panel.follow.value and self._showing.judged is not None:
            self._follow_at = time.monotonic() + SETTLE
        if self._chooser.needs_paths():
            if self._paths is not None:
                self._paths.give_up()
            self._showing.no_openings()
            self._paths = self._submit(PathsAsked(self._chooser.choice.place()))

    def _submit(self, asked: Asked) -> Ticket:
        def done(answered: Answered) -> None:
            self._answers.put((asked, answered))
            self.tell("answer")

        return self._desk.judges.submit(asked, done)

    def _check(self) -> None:
        self._give_up()
        question = self._chooser.choice.question()
        self._showing.outdated()
        self._ticket = self._submit(question)
        self._panel.stop.visible = self._panel.progress.visible = True
        self._panel.progress.value = 0.0
        self._panel.say("Asked …")

    def _stop(self) -> None:
        self._give_up()
        self._panel.say("Stopped: there is no new verdict.")

    def _give_up(self) -> None:
        """Nothing is waited for."""
        self._follow_at = None
        if self._ticket is not None:
            self._ticket.give_up()
            self._ticket = None
        self._panel.stop.visible = self._panel.progress.visible = False

    def _answered(self) -> None:
        while not self._answers.empty():
            asked, answered = self._answers.get()
            if self._ticket is not None and asked is self._ticket.asked:
                self._ticket = None
                self._panel.stop.visible = self._panel.progress.visible = False
                self._judged(answered)
            elif self._paths is not None and asked is self._paths.asked:
                self._paths = None
                self._opened(answered)

    def _judged(self, answered: Answered) -> None:
        if isinstance(answered, Problem):
            self._trouble(answered.detail)
        elif isinstance(answered, Judged):
            self._showing.verdict(answered, self._chooser.twin)
            self._panel.say(f"Judged in {answered.seconds:.1f} s.")

    def _opened(self, answered: Answered) -> None:
        if isinstance(answered, Problem):
            self._trouble(answered.detail)
        elif isinstance(answered, Paths):
            self._showing.openings(answered)

    def _tick(self, passed: float) -> None:
        now = time.monotonic()
        if self._showing.film.playing:
            self._showing.advance(passed)
        if self._follow_at is not None and now >= self._follow_at:
            self._check()
        if self._ticket is not None:
            self._progress(self._ticket, now)
        for at, transfer in self._refused:
            if now >= at:
                hide_progress(self._client, transfer)
        self._refused = [each for each in self._refused if now < each[0]]

    def _progress(self, ticket: Ticket, now: float) -> None:
        budget = self._chooser.choice.budget
        if ticket.began is None:
            ready = self._desk.judges.ready
            self._panel.say(WAITING if ready else GETTING_READY)
            return
        spent = now - ticket.began
        self._panel.progress.value = min(100 * spent / budget, 100.0)
        more = f"it searches for {budget:g} s at most" if spent <= budget else "a last look for a proof"
        self._panel.say(f"Judging, {spent:.1f} s: {more}.")

    def _motion(self) -> None:
        """A motion of the person's own is to be judged."""
        path = self._kept(self._panel.motion.value)
        self._chooser.use(motion=str(path))
        self._moved()
        self._panel.say(f"Motion {path.name}.")
        self._check()

    def _model(self) -> None:
        """A kitchen of the person's own."""
        path = self._kept(self._panel.model.value)
        if path.suffix != ".urdf":
            raise InputError(f"a kitchen in '{path.name}'", allowed=".urdf")
        if path.stem in {*self._desk.kitchens, *self._desk.robots}:
            path = path.rename(path.with_stem(f"{path.stem}{OWN}"))
        self._chooser.use(kitchen=str(path))
        self._showing.nothing()
        self._moved()
        self._panel.say(f"Kitchen {path.stem}.")

    def _kept(self, file: viser.UploadedFile) -> Path:
        """The file, in a folder of this person; each upload is another file."""
        self._files += 1
        folder = Path(self._folder.name) / str(self._files)
        folder.mkdir()
        path = folder / (Path(file.name).name or "file")
        with writing(Path(path.name)):
            path.write_bytes(file.content)
        return path

    def _refuse(self, transfer: str, why: str) -> None:
        """A file was refused; called from the server's own thread."""
        self._why = why
        self._refused.append((time.monotonic() + TICK, transfer))
        self.tell("refused")

    def _refusal(self) -> None:
        self._panel.refresh_uploads()
        self._trouble(self._why)

    def _save(self) -> None:
        judged = self._showing.judged
        if judged is not None:
            name = f"verdict-{judged.iri.rpartition('/')[2][:12]}.trig"
            self._client.send_file_download(name, judged.trig, save_immediately=True)
