"""Files of meshes that a saved twin names: found where they lie here, known by their content.

A graph holds where a mesh lay when its model was read, and the hash of its bytes. The place is in no content
hash; elsewhere the file may lie in another one. It is looked for by the ends of that place, longest first,
in folders of here, and taken if its bytes have the hash.
"""

from collections import defaultdict
from collections.abc import Iterable, Iterator, Sequence
from os.path import commonpath, isfile
from pathlib import Path
from typing import Final
from urllib.parse import quote, unquote, urlparse

import pyoxigraph as ox

from sdt_kg.errors import GraphError
from sdt_kg.iri import SDT, Iri, local_name
from sdt_kg.store import Triple, value_of
from sdt_kg.urdf.folder import MODELS, is_package, models_folder
from sdt_kg.urdf.meshes import PACKAGE, check_whole, mesh_hash

FILE: Final = SDT + "meshFile"
HASH: Final = SDT + "meshHash"
SHAPE: Final = SDT + "hasCollisionGeometry"


def with_files_here(triples: Sequence[Triple], model: Iri, beside: Path | None) -> list[Triple]:
    """The model's triples, each mesh where its file is here: where it was, beside, or in `SDT_MODELS`.

    Args:
        triples: What is asserted of it.
        model: Its IRI.
        beside: Folder of what was saved.

    Raises:
        GraphError: A file is not there, or another one.
        UrdfError: Its format may keep the shape in other files.
    """
    folders = [folder.resolve() for folder in (beside, models_folder()) if folder is not None]
    hashes = {subject: term.value for subject, predicate, term in triples if predicate == HASH}
    bodies = {term.value: subject for subject, predicate, term in triples if predicate == SHAPE}

    def here(triple: Triple) -> Triple:
        shape, predicate, term = triple
        if predicate != FILE or shape not in hashes or not isinstance(term, ox.NamedNode):
            return triple  # of a mesh that is not whole the check of the model tells
        body = local_name(bodies.get(shape, shape))
        where = f"mesh '{_shown(term.value)}' of body '{body}' of '{local_name(model)}'"
        file, others = _found(term.value, hashes[shape], folders)
        if file is None:
            raise _missing(where, others)
        check_whole(file, where)
        return shape, predicate, ox.NamedNode(file.as_uri())

    return [*map(here, triples)]


def _shown(address: Iri) -> str:
    parsed = urlparse(address)
    return unquote(parsed.path) if parsed.scheme == "file" else address


def _found(address: Iri, content: str, folders: Sequence[Path]) -> tuple[Path | None, list[str]]:
    """The file of that content, if it is at hand, and where others are that could be it."""
    others = list[str]()
    for file, told in _candidates(address, folders):
        if isfile(file):  # noqa: PTH113 - a path that no file can have is none, not an error
            if mesh_hash(file) == content:
                return file, []
            others.append(told)
    return None, others


def _missing(where: str, others: Sequence[str]) -> GraphError:
    known = "only its hash was saved, by which it is known"
    if others:
        found = f"{where} is another file than the one that was saved (found: '{others[0]}')"
        return GraphError(found, remedy=f"put that one there: {known}")
    return GraphError(
        f"{where} is not there",
        allowed="a file at that path, or at any end of it beside the saved twin or in a folder for models",
        remedy=f"put it back ({known}), or set {MODELS} to the folder that holds it",
    )


def _candidates(address: Iri, folders: Sequence[Path]) -> Iterator[tuple[Path, str]]:
    """Where the file may be, and how that is told: at its address, then at each end of it in each folder."""
    parsed = urlparse(address)
    parts = Path(unquote(parsed.path)).parts[1:]
    if parsed.scheme == "file":
        yield Path("/", *parts), _shown(address)
    else:
        parts = (unquote(parsed.netloc), *parts)
    if any("\0" in part or part == ".." for part in parts):
        return
    for folder in folders:
        for k in range(len(parts)):
            end = Path(*parts[k:])
            yield folder / end, str(end)


def portable(store: ox.Store, folders: Sequence[Path]) -> ox.Store:
    """A copy whose meshes are named `package://NAME/…`: no folder of this machine above NAME is told.

    NAME is the ROS package of a file, the nearest folder above it with a `package.xml`; else that of the
    folders which holds it; else the one that holds all other meshes of the model, so long as that is not
    the root, or the file's own.
    """
    copy, meshes = ox.Store(), defaultdict[str, list[tuple[ox.Quad, Path]]](list)
    for quad in store:
        if quad.predicate.value == FILE:
            file = Path(unquote(urlparse(str(value_of(quad.object))).path))
            meshes[str(quad.graph_name)].append((quad, file))
        else:
            copy.add(quad)
    known = [each.resolve() for each in folders]
    for named in meshes.values():
        tops = _tops([file for _, file in named], known)
        for quad, file in named:
            address = PACKAGE + quote(f"{tops[file].name}/{file.relative_to(tops[file]).as_posix()}")
            copy.add(ox.Quad(quad.subject, quad.predicate, ox.NamedNode(address), quad.graph_name))
    return copy


def _tops(files: Iterable[Path], known: Sequence[Path]) -> dict[Path, Path]:
    """The folder of each file at which its address begins."""
    tops = dict[Path, Path | None]()
    for file in files:
        package = next((each for each in file.parents if is_package(each)), None)
        tops[file] = package or next((each for each in file.parents if each in known), None)
    alone = [str(file.parent) for file, top in tops.items() if top is None]
    shared = Path(commonpath(alone)) if alone else Path()
    return {file: top or (shared if shared.name else file.parent) for file, top in tops.items()}
