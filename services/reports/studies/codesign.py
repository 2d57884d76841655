"""Which changes of a kitchen let which robots achieve more: coverage, world by world."""

from collections.abc import Iterator
from dataclasses import dataclass, replace

from matplotlib.ticker import MaxNLocator

from predicates.case import ArtefactKind, Outcome
from sdt_kg.errors import InputError
from sdt_kg.load import model_name
from sdt_kg.motion import BodyMotion
from services.app import Service, load
from services.codesign.asked import Asked, worlds_of
from services.codesign.entries import Entry as Judged
from services.codesign.entries import Found, Grid, How, found_of
from services.codesign.grid import Key, run
from services.codesign.report import (
    certified_of_judged,
    entry_rows,
    outcome_name,
    reuse_lines,
    reused,
    turned_rows,
    why,
    world_name,
)
from services.embodiment.certify.certificate import read_certificate
from services.physics.model import Scene
from services.reports.pages.figure import Figure, drawn
from services.reports.pages.table import Cell, Table
from services.reports.scene.clip import body_clip
from services.reports.scene.colors import COLORS
from services.reports.scene.view import View, view_of
from services.reports.studies.judged import check_kept, opened, policy_of
from services.whatif import World, changed, parse_change

Edits = tuple[str, ...]


@dataclass(frozen=True, slots=True, eq=False)
class Coverage:
    """A grid of worlds, robots and containers of one kitchen.

    Attributes:
        asked: What the grid is about.
        grid: Its entries, those of the world as it is first.
    """

    asked: Asked
    grid: Grid

    @property
    def worlds(self) -> tuple[Edits, ...]:
        """The world as it is, then the others."""
        return ((), *self.asked.worlds)

    def certified(self, edits: Edits, robot: str) -> int:
        """How many containers a robot is certified for in a world."""
        return sum(each.found.outcome is Outcome.CERTIFIED for each in self.cells(edits, robot))

    def cells(self, edits: Edits, robot: str) -> list[Judged]:
        """Cells of one robot in one world."""
        return [each for each in self.grid.entries if each.edits == edits and each.robot == robot]

    def best(self) -> Edits:
        """The world with the most certificates; of several, the one with the fewest edits."""
        return max(
            self.worlds,
            key=lambda edits: (sum(self.certified(edits, each) for each in self.asked.robots), -len(edits)),
        )


def covered(  # noqa: PLR0913 - the options of sdt whatif --grid
    kitchen: str,
    robots: str,
    task: str,
    edits: str,
    *,
    state: str = "",
    drive: str = "",
    friction: str = "",
    budget: float = 20.0,
    jobs: int = 1,
    store: str = "",
) -> Coverage:
    """Every container for every robot in every combination of edits.

    Args:
        kitchen: Bundled name or path.
        robots: Comma-separated.
        task: `open` or `close` of all containers, or `open:NAME,NAME`.
        edits: Axes separated by semicolons, the alternatives of one axis by `|`.
        state: Joints elsewhere, comma-separated.
        drive: omni, differential or fixed.
        friction: Coefficient with which fingers rub on handles, as text; empty: verdicts say what is needed.
        budget: Seconds of search for each container.
        jobs: Processes that judge.
        store: Where verdicts about the world as it is are recalled from and kept; empty: nowhere.

    Raises:
        InputError: Something of these does not exist.
    """
    verb, _, containers = task.partition(":")
    if verb not in {"open", "close"}:
        raise InputError(f"no task type '{verb}'", allowed="open, close, open:NAME,NAME")
    axes = _parts(edits, ";")
    if not axes:
        raise InputError("no edit is given", allowed="axes separated by ;", remedy="sdt whatif --edit help")
    asked = Asked(
        (kitchen,),
        _parts(robots, ","),
        verb,
        worlds_of(axes),
        policy_of(drive, budget=budget, friction=friction),
        _parts(state, ","),
        _parts(containers, ","),
    )
    with opened(store) as saved:
        service = replace(
            load(kitchen, asked.robots, state=asked.states, policy=asked.policy), recall=saved.stored
        )
        kept, counted = _kept(asked, service), asked.containers or service.twin.containers()
        check_kept(store, len(asked.robots) * len(counted) - len(kept))
        grid = run(asked, jobs, kept=kept)
        fresh = [each.found.record for each in grid.entries if each.found.record is not None]
        if fresh:
            saved.add_twin(service.twin)
        for record in fresh:
            saved.add_record(record)
    return Coverage(asked, grid)


def _kept(asked: Asked, service: Service) -> dict[Key, Found]:
    """What the store has of the world as it is."""
    (kitchen,) = asked.kitchens
    names = asked.containers or [each.name for each in service.twin.containers()]
    known = {each.name for each in service.twin.containers()}
    return {
        (kitchen, robot, name): found_of(verdict, How.KEPT, 0.0)
        for robot in asked.robots
        for name in names
        if name in known
        for verdict in service.stored(f"{asked.verb}:{name}", model_name(robot)) or ()
    }


def _parts(text: str, sign: str) -> tuple[str, ...]:
    return tuple(each.strip() for each in text.split(sign) if each.strip())


def counts(found: Coverage) -> Table:
    """Certified containers of each robot in each world, and by how many more."""
    rows = []
    for edits in found.worlds:
        row: dict[str, object] = {"world": world_name(edits), "edits": len(edits)}
        for robot in found.asked.robots:
            here, before = ([one.found for one in found.cells(each, robot)] for each in (edits, ()))
            row[robot] = certified_of_judged(here, before)
        rows.append(row)
    return Table.of(
        "codesign_counts",
        "Certified of judged containers in each world; in brackets the difference to the world as it is.",
        rows,
    )


def figure(found: Coverage) -> Figure:
    """Coverage of each robot in each world, as lines from the world as it is."""
    names = [world_name(each).replace("; ", "\n") for each in found.worlds]
    with drawn(0.3 * len(names) + 0.9) as drawing:
        axes = drawing.add_subplot()
        for number, robot in enumerate(found.asked.robots):
            shade = ("#26384f", "#b5651d", "#5d8a66", "#8a5d80")[number % 4]
            values = [_drawn(found, edits, robot) for edits in found.worlds]
            rows = [row + 0.16 * (number - (len(found.asked.robots) - 1) / 2) for row in range(len(names))]
            axes.hlines(rows, values[0], values, color=shade, linewidth=1.0)
            axes.plot(values, rows, "o", color=shade, markersize=4.5, label=robot)
            axes.axvline(values[0], color=shade, linewidth=0.6, linestyle=":")
        axes.set_yticks(range(len(names)), names, fontsize=6.5)
        axes.set_ylim(len(names) - 0.5, -0.5)
        axes.set_xlabel("certified containers; dotted: in the world as it is")
        axes.xaxis.set_major_locator(MaxNLocator(integer=True))
        axes.legend(loc="lower left", bbox_to_anchor=(0, 1.0), ncols=4, borderaxespad=0.2)
    return Figure("codesign_coverage", "Coverage of each robot, world by world.", drawing)


def _drawn(found: Coverage, edits: Edits, robot: str) -> float:
    """How many are certified; what cannot be drawn where nothing was judged."""
    judged = any(each.found.outcome is not None for each in found.cells(edits, robot))
    return found.certified(edits, robot) if judged else float("nan")


def matrix(found: Coverage) -> Table:
    """Every cell: worlds by robots and containers."""
    containers = list(dict.fromkeys(each.container for each in found.grid.entries))
    pairs = [(robot, container) for robot in found.asked.robots for container in containers]
    by = {(each.edits, each.robot, each.container): each for each in found.grid.entries}
    rows = [
        (robot, container, *(_field(by[edits, robot, container], found) for edits in found.worlds))
        for robot, container in pairs
    ]
    heads = ("robot", "container", *map(world_name, found.worlds))
    return Table(
        "codesign_matrix",
        "Every verdict, world by world; fields of the shown world play their motion.",
        heads,
        tuple(rows),
    )


def _field(cell: Judged, found: Coverage) -> Cell:
    outcome = cell.found.outcome
    color = "abstained" if outcome is None else "proved" if cell.found.is_proved else outcome.value
    clip = _clip_name(cell) if cell.edits == found.best() and _motion(cell) is not None else ""
    return Cell(outcome_name(cell).replace("_", " "), color if color in COLORS else "", clip, why(cell))


def turned(found: Coverage) -> Table:
    """What turned, which predicate, and why."""
    rows = [
        {key: value for key, value in row.items() if key != "kitchen"}
        | {"outcome": str(row["outcome"]).replace("_", " ")}
        for row in turned_rows(found.grid)
    ]
    return Table.of(
        "codesign_turned", "Every verdict that an edit turns.", rows or [{"world": "nothing turns"}]
    )


def verdicts(found: Coverage) -> Table:
    """Every verdict by its IRI, and where its outcome is from."""
    columns = {"edits": "world", "robot": "robot", "container": "container", "outcome": "outcome"}
    columns |= {"how": "from", "iri": "verdict"}
    rows = [{said: row[name] for name, said in columns.items()} for row in entry_rows(found.grid)]
    return Table.of(
        "codesign_verdicts",
        "Every verdict by its name, the hash of its inputs; of a search of the world as it is, that one's."
        " Those about the world as it is are kept where a store is named; sdt whatif tells of others.",
        rows,
    )


def reuse(found: Coverage) -> Table:
    """How much of the grid rests on searches in the world as it is."""
    rows = [{"in words": line.strip()} for line in reuse_lines(reused(found.grid))]
    return Table.of("codesign_reuse", "What was not searched again, and why that is sound.", rows)


def view(found: Coverage) -> View:
    """The best world: the kitchen after its edits, and what is certified there."""
    edits = found.best()
    scenes, clips = dict[str, Scene](), []
    for cell, world in _worlds(found, edits):
        motion = _motion(cell)
        if cell.robot not in scenes:
            scenes[cell.robot] = Scene(world.service.twin, world.robot_iri)
        if motion is not None and motion.robot == world.robot_iri:
            clips.append(body_clip(_clip_name(cell), scenes[cell.robot], motion))
    twin = next(iter(scenes.values())).twin
    return view_of(
        twin, list(scenes.values()), f"The world with the most certificates: {world_name(edits)}.", clips
    )


def _worlds(found: Coverage, edits: Edits) -> Iterator[tuple[Judged, World]]:
    """Each cell of a world with the world that it is about."""
    (kitchen,) = found.asked.kitchens
    service = load(kitchen, found.asked.robots, state=found.asked.states, policy=found.asked.policy)
    changes = tuple(map(parse_change, edits))
    for robot in found.asked.robots:
        world = changed(World(service, robot), changes)
        for cell in found.cells(edits, robot):
            yield cell, world


def _motion(cell: Judged) -> BodyMotion | None:
    """The motion of the cell's certificate."""
    artefact = cell.found.artefact
    if (
        cell.found.outcome is not Outcome.CERTIFIED
        or artefact is None
        or artefact.kind is not ArtefactKind.CERTIFICATE
    ):
        return None
    return read_certificate(artefact.content).motion


def _clip_name(cell: Judged) -> str:
    return f"{cell.robot}: {cell.container}"
