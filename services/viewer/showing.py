"""What one person sees of the world and of a verdict: scene, film and panel, kept in step."""

import numpy as np
import viser

from sdt_kg.iri import Iri
from sdt_kg.motion import BodyMotion, Motion
from sdt_kg.twin import Container, Twin
from services.viewer.judging.question import Judged, Opening, Paths
from services.viewer.panel import WHOLE, Panel
from services.viewer.picture.film import Film
from services.viewer.picture.looks import CLOSEST, OFFENDING, Looks
from services.viewer.picture.marks import Mark, What
from services.viewer.picture.skeleton import base_pose
from services.viewer.picture.standing import Pose2, kitchen_positions, parked
from services.viewer.picture.timeline import Posture, Timeline
from services.viewer.picture.viewpoint import fronts_of, largest, viewpoint
from services.viewer.scene.stage import Stage
from services.viewer.words import headline, nothing_yet, story

SHORT = 80
"""[characters] Of an entry of a drop-down."""


class Showing:
    """Scene, film and verdict of one person."""

    def __init__(self, client: viser.ClientHandle, panel: Panel) -> None:
        self.panel, self.stage, self.film = panel, Stage(client), Film(None)
        self.judged: Judged | None = None
        self.stale = False
        self._start = Posture(None, {}, {})
        self._openings: tuple[Opening, ...] = ()
        self._chosen: Mark | None = None
        self._labels: dict[str, Mark] = {}

    def world(self, twin: Twin, looks: tuple[Looks, Looks], start: Pose2, container: Container) -> None:
        """The twin in its state, the robot where it would begin; no film.

        Args:
            twin: Kitchen and robot.
            looks: Of kitchen and robot.
            start: Of the base: x, y [m], yaw [rad].
            container: What is asked about; another kitchen is looked at so that it is seen.
        """
        kitchen, robot = looks
        self._start = Posture(start, {}, dict(twin.state))
        annotation = twin.robot(twin.robots[0])
        if self.stage.furnish(kitchen, robot, annotation):
            self._openings = ()  # they were of the kitchen before
            joints = kitchen_positions(kitchen.skeleton, self._start.kitchen)
            stands = base_pose(robot.skeleton, annotation, start)
            hiding = (
                largest(kitchen, joints, np.eye(4)),
                largest(robot, parked(annotation, {}), stands),
            )
            view = viewpoint(fronts_of(kitchen, joints, container, twin.containers()), np.concatenate(hiding))
            if view is not None:
                self.stage.look(*view)
        self._forget_film()
        self.stage.pose(self._start)
        self._draw_paths()

    def _forget_film(self) -> None:
        self.film, self._chosen, self._labels = Film(None), None, {}
        self.panel.show_film(None)
        self.panel.look.visible = False
        self._point()

    def openings(self, paths: Paths) -> None:
        """These containers can be opened from here."""
        self._openings = paths.openings
        self._draw_paths()

    def no_openings(self) -> None:
        """It is not known (yet) which containers can be opened from here."""
        self._openings = ()
        self._draw_paths()

    def _draw_paths(self) -> None:
        self.stage.paths(self._openings, self._start.kitchen, seen=self.panel.paths.value)

    def outdated(self) -> None:
        """The verdict that is shown is about something else by now."""
        if self.judged is not None and not self.stale:
            self.stale = True
            self.panel.verdict.content = headline(self.judged, stale=True)

    def nothing(self) -> None:
        """No verdict is shown."""
        self.judged, self.stale = None, False
        self.panel.verdict.content, self.panel.story.content = nothing_yet(), ""
        self.panel.save.disabled = True

    def verdict(self, judged: Judged, twin: Twin) -> None:
        """The verdict in words; its film runs, or its first reason is looked at."""
        self.judged, self.stale = judged, False
        self.panel.verdict.content, self.panel.story.content = headline(judged, stale=False), story(judged)
        self.panel.save.disabled = False
        moved = judged.motion if isinstance(judged.motion, BodyMotion | Motion) else None
        timeline = None if moved is None else Timeline(moved, twin.state, twin.entities.coupling)
        self.film = Film(timeline, judged.marks)
        self.panel.show_film(None if timeline is None else timeline.duration)
        self._labels = {f"{k}. {mark.text}"[:SHORT]: mark for k, mark in enumerate(judged.marks, 1)}
        self.panel.offer(self.panel.look, [WHOLE, *self._labels], WHOLE)
        self.panel.look.visible = bool(self._labels)
        reasons = [name for name, mark in self._labels.items() if mark.reason is not None]
        if judged.outcome != "certified" and reasons:
            self.panel.look.value = reasons[0]
            self.look()
            return
        self._chosen = None
        self.film.play()
        self._posed()

    def look(self) -> None:
        """What was chosen to be looked at is shown, at the time at which it was measured."""
        self._chosen = self._labels.get(self.panel.look.value)
        self.film.playing = False
        at = None if self._chosen is None else self.film.when(self._chosen)
        if at is not None:
            self.film.time = at
        self._posed()

    def scrub(self) -> None:
        """The film is where its slider is."""
        self.film.time, self.film.playing = float(self.panel.time.value), False
        self._posed()

    def play(self) -> None:
        """The film runs, or stands."""
        if self.film.playing:
            self.film.playing = False
        else:
            self.film.play()
        self._posed()

    def advance(self, seconds: float) -> None:
        """So much time goes by."""
        self.film.advance(seconds * float(self.panel.speed.value.removesuffix("x")))
        self._posed()

    def seen(self) -> None:
        """What is to be seen is as the panel says."""
        self.stage.show(self.panel.collision.value, self.panel.visual.value)
        self._draw_paths()
        self._posed()

    def _posed(self) -> None:
        film = self.film
        self.panel.play.label = "Pause" if film.playing else "Play"
        if film.timeline is not None:
            self.panel.time.value = round(film.time, 2)
            self.panel.phase.content = film.says()
            self.stage.pose(film.timeline.at(film.time))
        self._point()

    def _point(self) -> None:
        """Ghost, colours and lines of what is looked at."""
        if not self.panel.pointed.value:
            self.stage.ghost(None)
            self.stage.paint(())
            self.stage.marks((), self._start)
            return
        chosen, film = self._chosen, self.film
        posture = self._posture_of(chosen)
        bad: tuple[Iri, ...] = () if chosen is None else chosen.bodies
        near = chosen is not None and chosen.what is What.NEAREST
        self.stage.paint(bad, CLOSEST if near else OFFENDING)
        self.stage.ghost(posture if chosen is not None and not near else None, bad)
        self.stage.marks(film.seen(chosen), posture or self._start)

    def _posture_of(self, mark: Mark | None) -> Posture | None:
        """Where everything was when it was measured."""
        at = None if mark is None else self.film.when(mark)
        if at is not None and self.film.timeline is not None:
            posture = self.film.timeline.at(at)
            if posture.base is not None:
                return posture
        start = None if self.judged is None else self.judged.start
        if mark is not None and mark.time == 0 and start is not None:
            return Posture(start, {}, self._start.kitchen)
        return None
