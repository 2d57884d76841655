"""Where a base may stand for a task: the answer to the question `place`."""

from dataclasses import dataclass

from predicates.case import Diagnosis
from services.embodiment.place.grid import Cell, Status

Pose = tuple[float, float, float]

DECIMALS = 9
"""[1] Of a pose, so that it can be asked again as it is printed: a tool is followed to within 1e-7 m, and an
arm of few joints makes up for no more than that with a base that stands."""


@dataclass(frozen=True, slots=True)
class Spot:
    """A base pose from which the task is certified with a fixed base.

    Attributes:
        x, y: [m].
        yaw: [rad].
        margin: Smallest distance of the certified motion from kitchen or robot itself [m],
            `LOOKED_UP_TO` of predicates.margins where nothing is nearer.
        gripper: That holds the handle.
    """

    x: float
    y: float
    yaw: float
    margin: float
    gripper: str


@dataclass(frozen=True, slots=True)
class Placement:
    """Where a base may stand for a task.

    Attributes:
        spots: Certified poses, best margin first.
        rows: The map, rows from the smallest y on.
        tried: How many candidate poses were asked about.
        diagnoses: Why there is no motion of the container at all, where there is none.
        seconds: That were spent.
    """

    container: str
    spots: tuple[Spot, ...]
    rows: tuple[tuple[Cell, ...], ...]
    tried: int
    diagnoses: tuple[Diagnosis, ...]
    seconds: float

    @property
    def best(self) -> Spot | None:
        """The certified pose with the largest margin."""
        return self.spots[0] if self.spots else None

    @property
    def impossible(self) -> bool:
        """Whether every pose of the map is proved impossible."""
        return bool(self.rows) and all(cell.status is Status.PROVED for row in self.rows for cell in row)
