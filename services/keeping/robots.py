"""Robots as they were read: their graphs, kept on disk, as reading and checking a URDF takes 0.1 s."""

import hashlib
import json
from collections.abc import Iterable, Iterator, Sequence
from functools import cache
from pathlib import Path
from xml.etree import ElementTree as ET

import numpy as np
import pyoxigraph as ox

import ontology
import robots
import sdt_kg
from sdt_kg import load
from sdt_kg.entities import Entities
from sdt_kg.errors import UrdfError
from sdt_kg.iri import Iri
from sdt_kg.store import Term, Triple
from sdt_kg.urdf.meshes import mesh_hash, mesh_path
from services.keeping.files import place, read, write
from services.versions import version_of

ROBOTS = "robots"
"""Kind of what is kept."""

KEPT_OF = ".urdf"
"""Files of robots of which something is kept; a xacro reads others."""

Mesh = tuple[str, str, str]
"""How a URDF names it, where it lies, and the hash of its content."""


def read_robot(robot: str | Path) -> Entities:
    """What `load.read_robot` gives: as it was kept of the same files, or read and kept for the next time.

    Raises:
        UnknownEntityError, UrdfError, AnnotationError: As there.
    """
    urdf = load.model_path("robot", robot)
    if urdf.suffix != KEPT_OF:
        return load.read_robot(robot)
    key = _follows_from(urdf)
    path = place(ROBOTS, key)
    found = _recalled(read(path), urdf)
    if found is None:
        found = load.read_robot(robot)
        if not found.containers and _follows_from(urdf) == key:  # nobody wrote the files meanwhile
            write(path, _told(found, _meshes(urdf)))
    return found


def _follows_from(urdf: Path) -> tuple[object, ...]:
    """All that decides what is read of a robot, but for its meshes."""
    beside = urdf.with_suffix(".ttl")
    files = (_hash(each.read_bytes()) if each.is_file() else "" for each in (urdf, beside))
    return (_code(), str(urdf.absolute()), *files)


def _hash(content: bytes) -> str:
    return hashlib.sha256(content).hexdigest()


@cache
def _code() -> str:
    """Hash of the code that reads robots, of what it reads besides, and versions of what parses."""
    sources = sorted(Path(str(sdt_kg.__file__)).parent.rglob("*.py"))
    read_too = (ontology.path("sdt.ttl"), ontology.path("tee.ttl"), *ontology.path("rules").glob("*.rq"))
    own = (*sources, Path(__file__), *sorted(read_too), *sorted(robots.path("").glob("*/*.ttl")))
    versions = ox.__version__, np.__version__, version_of("yourdfpy")
    return _hash(b"".join(each.read_bytes() for each in own)) + repr(versions)


def _meshes(urdf: Path) -> list[Mesh]:
    """Meshes of collision shapes, each once."""
    shapes = ET.fromstring(urdf.read_bytes()).iterfind("link/collision/geometry/mesh")  # noqa: S314 - read before
    names = sorted({each.get("filename", "") for each in shapes})
    return [(name, str(path), mesh_hash(path)) for name in names for path in [mesh_path(name, urdf, "")]]


def _told(robot: Entities, meshes: Sequence[Mesh]) -> bytes:
    """The robot as text: every name and value once, and the triples of each graph as numbers of these."""
    names, terms = dict[Iri, int](), dict[Term, int]()
    model, graphs = robot.environment, dict[Iri, list[int]]()
    for graph in robot.graphs_of(model):
        graphs[graph] = [*_numbered(robot.store.triples(graph), names, terms)]
    values = [_text(term) for term in terms]
    hashed = robot.content_hash(model)
    told = model, hashed, robot.notes, meshes, list(names), values, graphs
    return json.dumps(told).encode()


def _numbered(
    triples: Iterable[Triple], names: dict[Iri, int], terms: dict[Term, int]
) -> Iterator[int]:
    for subject, predicate, value in triples:
        yield names.setdefault(subject, len(names))
        yield names.setdefault(predicate, len(names))
        yield terms.setdefault(value, len(terms))


def _text(term: Term) -> tuple[str, ...]:
    if isinstance(term, ox.NamedNode):
        return (term.value,)
    return term.value, term.datatype.value, term.language or ""


def _term(text: Sequence[str]) -> Term:
    if len(text) == 1:
        return ox.NamedNode(text[0])
    value, datatype, language = text
    return ox.Literal(value, language=language) if language else ox.Literal(value, datatype=ox.NamedNode(datatype))


def _recalled(content: bytes | None, urdf: Path) -> Entities | None:
    """The robot that was kept, if its meshes are the same files still."""
    if content is None:
        return None
    model, hashed, notes, meshes, names, values, graphs = json.loads(content)
    if not _are_there(meshes, urdf):
        return None
    terms = list(map(_term, values))
    made: dict[Iri, list[Triple]] = {}
    for graph, numbers in graphs.items():
        one = iter(numbers)
        made[graph] = [(names[s], names[p], terms[o]) for s, p, o in zip(one, one, one, strict=True)]
    return Entities.recalled(model, made, notes, hashed)


def _are_there(meshes: Iterable[Mesh], urdf: Path) -> bool:
    """Whether the URDF's names lead to the same files with the same content."""
    try:
        return all(
            str(path := mesh_path(name, urdf, "")) == where and mesh_hash(path) == hashed
            for name, where, hashed in meshes
        )
    except (UrdfError, OSError):
        return False
