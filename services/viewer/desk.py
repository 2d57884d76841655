"""What all people who look share: the models on offer, what they look like, and the judges."""

import threading
from collections import OrderedDict
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Final

from sdt_kg.errors import UrdfError
from sdt_kg.iri import Iri
from sdt_kg.load import bundled
from sdt_kg.scope import D_ARTIC, D_ARTIC_DYN
from sdt_kg.twin import Twin
from services.app import DEFAULT_BUDGET
from services.viewer.judging.judges import Judges
from services.viewer.judging.places import Places
from services.viewer.judging.question import Place
from services.viewer.picture.looks import Colour, Looks, kitchen_colours, robot_colours
from services.viewer.picture.shapes import Surface, collision_surfaces, visual_surfaces
from services.viewer.picture.skeleton import Skeleton

KEPT: Final = 16
"""Models whose looks are kept."""
CLASSES: Final = (D_ARTIC.name, D_ARTIC_DYN.name)
"""TEE classes that the Law can be asked about."""


@dataclass
class Desk:
    """Shared by everybody; what is chosen is not.

    Attributes:
        kitchens, robots: Name as it is shown → bundled name or path.
        judges: Processes that judge.
        budget: Of a search [s].
        friction: With which fingers rub on handles at first [1]; None: verdicts say what is needed.
    """

    kitchens: Mapping[str, str]
    robots: Mapping[str, str]
    judges: Judges
    budget: float = DEFAULT_BUDGET
    friction: float | None = None
    _places: Places = field(default_factory=Places)
    _looks: OrderedDict[tuple[str, str], Looks] = field(default_factory=OrderedDict[tuple[str, str], Looks])
    _lock: threading.RLock = field(default_factory=threading.RLock)

    def twin(self, place: Place) -> Twin:
        """The twin of a place; the same errors as on the shell."""
        with self._lock:
            return self._places.twin(place)

    def kitchen(self, twin: Twin, source: str) -> Looks:
        """What the kitchen looks like.

        Raises:
            UrdfError: A mesh cannot be read.
        """
        return self._look(twin, twin.environment, "kitchen", source, kitchen_colours)

    def robot(self, twin: Twin, source: str) -> Looks:
        """What the robot looks like."""
        robot = twin.robots[0]
        return self._look(twin, robot, "robot", source, lambda it: robot_colours(it, robot))

    def _look(
        self, twin: Twin, model: Iri, kind: str, source: str, colours: Callable[[Twin], dict[str, Colour]]
    ) -> Looks:
        key = (twin.content_hash(model), source)
        with self._lock:
            if key not in self._looks:
                mechanism = twin.mechanism(model)
                collision = collision_surfaces(mechanism, hulls=kind == "robot")
                visual, note = _visual(_urdf(kind, source))
                self._looks[key] = Looks(Skeleton.of(mechanism), collision, visual, colours(twin), note)
            self._looks.move_to_end(key)
            while len(self._looks) > KEPT:
                self._looks.popitem(last=False)
            return self._looks[key]


def _visual(urdf: Path) -> tuple[dict[str, Surface], str]:
    """What bodies look like; where that cannot be read, nothing, and why: a verdict needs none of it."""
    try:
        return visual_surfaces(urdf), ""
    except UrdfError as error:
        return {}, f"what bodies look like cannot be shown: {error}"


def _urdf(kind: str, source: str) -> Path:
    own = bundled(kind, source) if "/" not in source else Path(source)
    return own if own.is_file() else Path(source)
