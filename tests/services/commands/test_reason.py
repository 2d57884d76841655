"""`sdt reason`: which engine ran, what clashes, and where the inferred types are."""

from pathlib import Path

import pyoxigraph as ox
import pytest

from sdt_kg.history.diff import quads_of_twin
from sdt_kg.iri import RDF, SDT, body_iri
from services.store.reason import Engine, default_engine
from tests.small import FOLDER, small_twin

DRAWER = ox.NamedNode(body_iri("b", "top_drawer"))
G = ox.NamedNode("https://example.org/g")


def test_without_java_hermit_is_refused_and_owlrl_is_taken(monkeypatch: pytest.MonkeyPatch, sdt) -> None:
    monkeypatch.setenv("PATH", "")
    assert default_engine() is Engine.OWLRL
    done = sdt("reason", str(FOLDER / "b.urdf"), "--engine", "hermit")
    assert (done.code, "HermiT needs Java" in done.err) == (2, True)
    assert sdt("reason", str(FOLDER / "b.urdf")).out.startswith("no contradiction found, says owlrl; ")


def test_the_command_says_which_engine_ran_and_what_clashes(sdt, tmp_path: Path) -> None:
    bad, good = tmp_path / "bad.nq", tmp_path / "good.nq"
    store = ox.Store()
    store.extend(quads_of_twin(small_twin("b")))
    store.add(ox.Quad(DRAWER, ox.NamedNode(RDF + "type"), ox.NamedNode(SDT + "RevoluteJoint"), G))
    store.dump(bad, ox.RdfFormat.N_QUADS)
    done = sdt("reason", str(bad), "--engine", "owlrl")
    assert done.code == 1
    assert done.out.startswith("inconsistent, says owlrl\n  ")
    done = sdt("reason", str(FOLDER / "b.urdf"), "--engine", "owlrl", "-o", str(good), "--json")
    assert (done.code, done.json["consistent"]) == (0, True)
    graph = "GRAPH <https://example.org/id/graph/reasoned/owlrl> { ?x a sdt:Joint }"
    assert sdt("query", str(good), f"SELECT (COUNT(?x) AS ?n) {{ {graph} }}", "--json").json[0]["n"] > 2
    assert sdt("reason", str(tmp_path / "nowhere.nq")).code == 2
