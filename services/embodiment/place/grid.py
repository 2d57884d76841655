"""A map of base positions about a handle: what is proved out of reach, and what the furniture takes up."""

from collections.abc import Callable
from dataclasses import dataclass, replace
from enum import Enum

import numpy as np
from numpy.typing import NDArray

from services.embodiment.body.world import Rules, World
from services.embodiment.prove import Prover

Array = NDArray[np.float64]

CELLS = 16  # along each side of the map
SIDE = 2.4  # [m] of the map, about the handle
ANGLES = 12  # at which the parked robot is tried in the middle of a cell
SMALLEST = 2  # [1] cells along each side of a square that is tried on its own
BOXES = 400  # of a proof about a part of the map, for each gripper and value of the container


class Status(Enum):
    """What is known of the base poses in a cell."""

    CERTIFIED = "certified"
    PROVED = "proved impossible"
    BLOCKED = "blocked"
    UNKNOWN = "unknown"


@dataclass(frozen=True, slots=True)
class Cell:
    """A square of base positions, at all angles.

    Attributes:
        x, y: Its middle [m].
        status: CERTIFIED: from a pose in it the task is certified. PROVED: from none in it the handle
            can be held all along. BLOCKED: the robot, parked in its middle, touches something at
            every angle that was tried. Else UNKNOWN.
        margin: Of the best certified pose in it [m], see `Spot`.
    """

    x: float
    y: float
    status: Status = Status.UNKNOWN
    margin: float | None = None


def cells(middle: Array) -> list[list[Cell]]:
    """The unknown map about a point (2,), rows from the smallest y on."""
    width = SIDE / CELLS
    ends = (np.arange(CELLS) + 0.5) * width - SIDE / 2
    return [[Cell(float(middle[0] + x), float(middle[1] + y)) for x in ends] for y in ends]


@dataclass(frozen=True, slots=True, eq=False)
class Excluder:
    """Proves squares of the map impossible.

    Attributes:
        prover: Of the container and a fixed base, wherever.
        late: Whether the time for it is spent.
    """

    prover: Prover
    late: Callable[[], bool]

    def exclude(self, rows: list[list[Cell]]) -> None:
        """Mark what is proved, whole squares first."""
        self._square(rows, 0, 0, CELLS)

    def _square(self, rows: list[list[Cell]], row: int, column: int, count: int) -> None:
        if self.late():
            return
        within = [cell for line in rows[row : row + count] for cell in line[column : column + count]]
        first, last = rows[row][column], rows[row + count - 1][column + count - 1]
        middle = (first.x + last.x) / 2, (first.y + last.y) / 2, 0.0
        half = count * SIDE / CELLS / 2
        prover = self.prover.standing(middle, (half, half, np.pi))
        held = any(cell.status is Status.CERTIFIED for cell in within)
        if not held and prover.excludes(BOXES):
            for i in range(row, row + count):
                for j in range(column, column + count):
                    rows[i][j] = replace(rows[i][j], status=Status.PROVED)
        elif count > SMALLEST:
            part = count // 2
            for i in (row, row + part):
                for j in (column, column + part):
                    self._square(rows, i, j, part)


def block(rows: list[list[Cell]], world: World, outside: Rules, late: Callable[[], bool]) -> None:
    """Mark unknown cells in whose middle the parked robot touches something at every angle."""
    yaws = np.linspace(-np.pi, np.pi, ANGLES, endpoint=False)
    for row in rows:
        for j, cell in enumerate(row):
            if cell.status is not Status.UNKNOWN or late():
                continue
            poses = (world.scene.q((cell.x, cell.y, yaw), {}) for yaw in yaws)
            if all(world.contact(q[None], outside) is not None for q in poses):
                row[j] = replace(cell, status=Status.BLOCKED)
