"""Saved verdicts, artefacts and twins, as files hold them."""

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass
from itertools import chain
from pathlib import Path

import pyoxigraph as ox

from predicates.case import Artefact
from predicates.record import StoredVerdict, read_artefact, read_verdict, verdicts_of
from predicates.record.seal import check_seal
from predicates.specification.results.stored import StoredResult, read_result, results_of
from sdt_kg.errors import InputError, StoreUnavailableError
from sdt_kg.interchange.rebuild import rebuilt_entities
from sdt_kg.iri import Iri, graph_iri, local_name, verdict_iri
from sdt_kg.load import load_twin
from sdt_kg.twin import Twin
from services.embodiment.recheck.models import Models
from services.store.files import folder_of_place, readable
from services.store.folder import reading
from services.store.models import is_graph_of, replaced_model
from services.store.on_disk import JOURNAL, folder_as_it_is, in_folder, is_only_read, opening
from services.store.server.remote import is_url

FORMATS = {".trig": ox.RdfFormat.TRIG, ".nq": ox.RdfFormat.N_QUADS}


@dataclass(frozen=True, slots=True)
class Entry:
    """A verdict with its artefact.

    Attributes:
        stored: None where the record is damaged.
        artefact: None where there is none.
        damage: Why the record cannot be read; empty if it can.
    """

    iri: Iri
    stored: StoredVerdict | None
    artefact: Artefact | None
    damage: str = ""


class Saved:
    """A store of verdicts, with the twins that they are about where those were saved too.

    Args:
        place: A .trig or .nq file, a store directory, or the address of a SPARQL server.

    Attributes:
        left_out: What of the place is not looked at, and why; empty where all of it is.

    Raises:
        InputError: It is none of these, or no RDF.
        StoreError: The server does not answer, or the directory is damaged; likewise when it is read.
    """

    def __init__(self, place: Path | str) -> None:
        if not place:
            raise InputError("no file or store at ''", allowed="a file, a store, or leave --store out")
        path = self._path = Path(place)
        self._beside = folder_of_place(place)
        self.left_out = "" if is_place_of_server(place) else _settled(path)
        self.store = _fetched(str(place)) if is_place_of_server(place) else _opened(path)

    def entries(self) -> Iterator[Entry]:
        """Every verdict, with its artefact; by IRI."""
        yield from map(self._entry, self.verdicts())

    def results(self) -> list[Iri]:
        """IRIs of the results of tasks; the verdicts of their steps are entries."""
        with reading(self._path):
            return results_of(self.store)

    def verdicts(self) -> list[Iri]:
        """IRIs of the verdicts."""
        with reading(self._path):
            return verdicts_of(self.store)

    def result(self, iri: Iri) -> StoredResult:
        """The result of this IRI.

        Raises:
            InputError: Its record is damaged, or was changed.
        """
        graph = ox.NamedNode(graph_iri("task_result", local_name(iri)))
        with reading(self._path):
            return read_result(self.store.quads_for_pattern(None, None, None, graph), iri)

    def entry(self, iri: Iri) -> Entry:
        """The verdict of this IRI, or of this hash.

        Raises:
            InputError: There is none.
        """
        known = verdict_iri(local_name(iri))
        if known not in self.verdicts():
            raise InputError(
                f"no verdict {iri} in this store", allowed="the IRI of a verdict that is saved in it"
            )
        return self._entry(known)

    def _entry(self, iri: Iri) -> Entry:
        graph = ox.NamedNode(graph_iri("verdict", local_name(iri)))
        try:
            with reading(self._path):
                quads = list(self.store.quads_for_pattern(None, None, None, graph))
                check_seal(iri, quads)
                stored = read_verdict(quads, iri)
                return Entry(iri, stored, read_artefact(self.store, iri))
        except InputError as error:
            return Entry(iri, None, None, str(error))

    def twin(self, models: Models) -> tuple[Twin, str]:
        """The twin, of the saved graphs if they have both models, else of the bundled ones of their names.

        It is where its models start: of which of them the saved states are is not known yet.

        Raises:
            InputError: The graphs were changed, or nothing has that name.
        """
        (environment, _), (robot, _) = models
        graphs = [ox.NamedNode(graph_iri("asserted", local_name(model))) for model in (environment, robot)]
        with reading(self._path):
            if not all(map(self.store.contains_named_graph, graphs)):
                return by_name(models)
            replaced = {
                model: quads
                for model, content_hash in models
                if (quads := replaced_model(self.store, model, content_hash)) is not None
            }
            quads = self._with(replaced) if replaced else self.store
            entities = rebuilt_entities(quads, environment, [robot], self._beside)
        source = "models of the saved graphs"
        if replaced:
            names = " and ".join(map(local_name, replaced))
            source += f", with what was kept of {names} when another of that name took its place"
        return Twin(entities, entities.coupling.start()), source

    def _with(self, replaced: Mapping[Iri, Iterable[ox.Quad]]) -> Iterator[ox.Quad]:
        """All quads of named graphs, but of these models those which are given."""
        for graph in self.store.named_graphs():
            name = graph.value if isinstance(graph, ox.NamedNode) else ""
            if not any(is_graph_of(model, name) for model in replaced):
                yield from self.store.quads_for_pattern(None, None, None, graph)
        yield from chain.from_iterable(replaced.values())


def by_name(models: Models) -> tuple[Twin, str]:
    """The twin of the bundled models of these names."""
    (environment, _), (robot, _) = models
    kitchen, machine = local_name(environment), local_name(robot)
    return load_twin(kitchen, [machine]), "models loaded by name: only names were saved"


def is_place_of_server(place: Path | str) -> bool:
    """Whether the place is the address of a server."""
    return isinstance(place, str) and is_url(place)


def _fetched(address: str) -> ox.Store:
    """All that a server has."""
    server = readable(address)
    try:
        return server.dump()
    finally:
        server.close()


def _settled(path: Path) -> str:
    """What a killed process left in a directory's journal is put where it is read; else why it is not."""
    journal = path / JOURNAL
    if not journal.is_file() or not journal.stat().st_size or is_only_read(path):
        return ""
    try:
        in_folder(path).close()
    except (InputError, StoreUnavailableError) as error:
        return f"what is in {journal} is not looked at: {error}"
    return ""


def _opened(path: Path) -> ox.Store:
    if path.is_dir():
        if not (path / "CURRENT").exists():
            raise InputError(f"{path} is no store", allowed="a directory that --save made")
        if is_only_read(path):
            return folder_as_it_is(path)
        with opening(path):
            return ox.Store.read_only(str(path))
    if path.suffix not in FORMATS or not path.is_file():
        raise InputError(f"no saved verdicts at {path}", allowed="a .trig or .nq file, or a store directory")
    store = ox.Store()
    try:
        store.load(path=str(path), format=FORMATS[path.suffix])
    except SyntaxError as error:
        raise InputError(f"{path} is not valid RDF: {error}", allowed="TriG or N-Quads") from None
    return store
