"""Kitchen and robots, by bundled name or path, → Twin."""

from collections.abc import Sequence
from dataclasses import replace
from functools import lru_cache
from pathlib import Path
from typing import Final

import pyoxigraph as ox

import kitchens
import robots as bundled_robots
from sdt_kg.annotating.annotate import TEE_GRAPH, annotate, tee_triples
from sdt_kg.annotating.files import Chosen, chosen_kitchen, chosen_robot, described, with_annotation
from sdt_kg.entities import Entities
from sdt_kg.errors import AnnotationError, GraphError, InputError, UnknownEntityError, UrdfError
from sdt_kg.interchange import stored
from sdt_kg.iri import Iri, graph_iri, local_name, model_iri
from sdt_kg.mechanism import Mechanism
from sdt_kg.scenes import SCENE_SUFFIXES, read_scene, scene_stem
from sdt_kg.store import MemoryStore
from sdt_kg.triples import mechanism_triples
from sdt_kg.twin import Twin
from sdt_kg.urdf import model_stem, read_mechanism

GRAPH_FORMATS: Final = {".nq": ox.RdfFormat.N_QUADS, ".trig": ox.RdfFormat.TRIG}
MODEL_SUFFIXES: Final = (".urdf", ".xacro")
KEPT: Final = 8
"""[1] Twins of bundled models that a process keeps, for whoever loads them again."""
_FOLDERS: Final = {"kitchen": kitchens.path, "robot": bundled_robots.path}


def load_twin(
    kitchen: str | Path,
    robots: Sequence[str | Path] = (),
    annotation: str | Path | None = None,
) -> Twin:
    """Twin of a kitchen with robots, all containers closed; a saved one in the state in which it was.

    Bundled models are read once as long as their files stay as they are: nothing writes to a twin.

    Args:
        kitchen: Bundled name (`a`, `b`) or path of a URDF, xacro, MJCF (`.xml`) or SDF file, or of a
            saved twin (`.nq`, `.trig`), whose robots are there too.
        robots: Bundled names (`pr2`, `tiago_dual`, `stretch`) or paths.
        annotation: `.ttl` of the robot, or of the kitchen, whichever it describes; by default the
            one beside the model, else the bundled one that fits.

    Raises:
        UnknownEntityError: No bundled model of that name.
        UrdfError: A file that is not a valid URDF tree.
        AnnotationError: A robot's annotation is missing or contradicts its URDF.
        GraphError: A saved twin is not whole, or was changed.
    """
    kitchen_file, robot_files = _explicit(annotation, robots)
    if Path(kitchen).suffix in GRAPH_FORMATS:
        return _saved(Path(kitchen), kitchen_file, list(zip(robots, robot_files, strict=True)))
    named = (("kitchen", kitchen), *(("robot", robot) for robot in robots))
    if annotation is None and all(_is_bundled(kind, str(name)) for kind, name in named):
        files = tuple(_files(bundled(kind, str(name))) for kind, name in named)
        return _once(str(kitchen), tuple(map(str, robots)), files)
    return _read(kitchen, robots, kitchen_file, robot_files)


@lru_cache(KEPT)
def _once(kitchen: str, robots: tuple[str, ...], _files: tuple[object, ...]) -> Twin:
    """The twin of bundled models whose files are these."""
    return _read(kitchen, robots, None, [None] * len(robots))


def _files(model: Path) -> tuple[tuple[str, int, int], ...]:
    """The files in a model's folder, with when they were written and how long they are."""
    found = ((str(file), file.stat()) for file in sorted(model.parent.iterdir()))
    return tuple((file, stat.st_mtime_ns, stat.st_size) for file, stat in found)


def _read(
    kitchen: str | Path,
    robots: Sequence[str | Path],
    kitchen_file: Path | None,
    robot_files: Sequence[Path | None],
) -> Twin:
    store = MemoryStore()
    store.add(TEE_GRAPH, tee_triples())
    asserted: dict[Iri, Iri] = {}
    inferred: dict[Iri, tuple[Iri, ...]] = {}
    notes: list[str] = []
    parts = [_kitchen(kitchen, kitchen_file)]
    parts += [_robot(robot, file) for robot, file in zip(robots, robot_files, strict=True)]
    for mechanism, kind, chosen in parts:
        model = model_iri(mechanism.name)
        if model in asserted:
            raise InputError(f"two models are named '{mechanism.name}'", allowed="each name once")
        asserted[model] = graph_iri("asserted", mechanism.name)
        store.add(asserted[model], with_annotation(mechanism_triples(mechanism, kind), chosen))
        inferred[model] = tuple(annotate(store, model, asserted[model]))
        notes += _notes(mechanism, chosen)
    environment, *others = asserted
    return Twin(Entities(store, environment, tuple(others), asserted, inferred, tuple(notes)))


def _saved(path: Path, annotation: Path | None, robots: Sequence[tuple[str | Path, Path | None]]) -> Twin:
    """The twin that was saved, with those of the robots that it does not have."""
    if not path.is_file():
        raise InputError(f"no file at {path}", allowed="a saved twin")
    if annotation is not None:
        raise AnnotationError(f"{annotation} is for a model, {path} is a saved twin", allowed="a robot's")
    try:
        store = stored(ox.parse(path=path, format=GRAPH_FORMATS[path.suffix]))
    except SyntaxError as error:
        raise GraphError(f"{path} is not RDF: {error}", allowed="TriG or N-Quads") from None
    return _with(Twin.from_quads(store, beside=path.parent), robots)


def read_robot(robot: str | Path, annotation: Path | None = None) -> Entities:
    """A robot by bundled name or path, with its annotation, alone: it can stand in any number of kitchens.

    Raises:
        UnknownEntityError, UrdfError, AnnotationError: As `load_twin`.
    """
    mechanism, kind, chosen = _robot(robot, annotation)
    triples = with_annotation(mechanism_triples(mechanism, kind), chosen)
    return Entities.alone(model_iri(mechanism.name), triples, _notes(mechanism, chosen))


def with_robot(twin: Twin, robot: Entities) -> Twin:
    """The same twin in the same state, with a robot unless it has it.

    Several twins of one kitchen share so what was read of it, and those with one robot what was read of that.
    """
    if robot.environment in twin.robots:
        return twin
    return Twin(twin.entities.beside(robot), twin.state)


def _with(twin: Twin, robots: Sequence[tuple[str | Path, Path | None]]) -> Twin:
    here = set(map(local_name, twin.robots))
    for robot, file in robots:
        if model_name(robot) not in here:
            twin = with_robot(twin, read_robot(robot, file))
    return twin


def _explicit(
    annotation: str | Path | None, robots: Sequence[str | Path]
) -> tuple[Path | None, list[Path | None]]:
    """The annotation file for the kitchen, and for each robot, as far as one was given."""
    nobody: list[Path | None] = [None] * len(robots)
    if annotation is None:
        return None, nobody
    file = Path(annotation)
    kind, name = described(file)
    if kind == "Environment":
        return file, nobody
    if len(robots) == 1:
        return None, [file]
    meant = [file if model_name(robot) == name else None for robot in robots]
    if file not in meant:
        raise AnnotationError(
            f"{file} describes robot '{name}', which is not loaded",
            allowed=", ".join(map(model_name, robots)) or "no robot is loaded",
        )
    return None, meant


def model_name(name_or_path: str | Path) -> str:
    """Name of a model as people see it: the bundled name, or the stem of the file."""
    path = Path(name_or_path)
    return scene_stem(path) if path.suffix in SCENE_SUFFIXES else model_stem(path)


def _kitchen(name: str | Path, explicit: Path | None) -> tuple[Mechanism, str, Chosen]:
    path = model_path("kitchen", name)
    scene = path.suffix in SCENE_SUFFIXES
    mechanism = read_scene(path) if scene else read_mechanism(path, turn_axes=True)
    _check_names(mechanism, path)
    mechanism = replace(mechanism, notes=(*mechanism.notes, *mechanism.oversized))
    return mechanism, "Environment", chosen_kitchen(mechanism, path, explicit)


def _check_names(mechanism: Mechanism, path: Path) -> None:
    if unseen := mechanism.unseen():
        raise UrdfError(
            f"{str(path)!r}: the name {unseen} has what cannot be seen",
            allowed="names without line breaks, control characters, and spaces at an end",
            remedy="rename it",
        )


def _robot(name: str | Path, explicit: Path | None) -> tuple[Mechanism, str, Chosen]:
    path = model_path("robot", name)
    mechanism = read_mechanism(path)
    _check_names(mechanism, path)
    return mechanism, "Robot", chosen_robot(mechanism, path, explicit)


def bundled(kind: str, name: str) -> Path:
    """Where the URDF of a bundled `kitchen` or `robot` lies, or would lie."""
    return _FOLDERS[kind](name) / f"{name}.urdf"


def bundled_names(kind: str) -> list[str]:
    """Names of all bundled models of a kind, `kitchen` or `robot`."""
    return sorted(each.parent.name for each in _FOLDERS[kind]("").glob("*/*.urdf"))


def _is_bundled(kind: str, name: str) -> bool:
    return "/" not in name and bundled(kind, name).is_file()


def model_path(kind: str, name_or_path: str | Path) -> Path:
    """URDF file of a bundled name, or the path as given; of kitchens also scene files.

    Raises:
        UnknownEntityError: Neither.
    """
    text = str(name_or_path)
    if _is_bundled(kind, text):
        return bundled(kind, text)
    path = Path(name_or_path)
    scenes, graphs = (SCENE_SUFFIXES, tuple(GRAPH_FORMATS)) if kind == "kitchen" else ((), ())
    suffixes = (*MODEL_SUFFIXES, *scenes)
    if path.suffix in suffixes and path.is_file():
        return path
    remedy = f"a bundled name, or the path of a file that is there ({', '.join((*suffixes, *graphs))})"
    if path.is_file():
        remedy = f"that is a file, {_why_none(path, kind)}: {remedy}"
    elif path.is_dir():
        remedy = f"that is a folder: {remedy}"
    raise UnknownEntityError(kind, text, bundled_names(kind), remedy)


def _why_none(path: Path, kind: str) -> str:
    """Why no model is read from a file."""
    if kind == "kitchen" and path.suffix == ".ttl":
        return "but Turtle does not keep what is stated of a model and what is inferred apart, as .trig does"
    return f"but its suffix '{path.suffix}' is none of these"


def _notes(mechanism: Mechanism, chosen: Chosen) -> list[str]:
    name = mechanism.name
    notes = [f"{name}: {note}" for note in (*mechanism.notes, *chosen.notes)]
    return notes + [
        f"{name}: joint '{joint.name}': {note}" for joint in mechanism.joints for note in joint.notes
    ]
