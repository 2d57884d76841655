"""`sdt containers`, `graph`, `scope`, `satisfies`, `causes`, `query`."""

import csv
import io
import re
import signal
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
import pytest
import rdflib

from sdt_kg.iri import SDT
from sdt_kg.load import bundled
from tests.services.http.test_interrupted import heard

SMALL = Path(__file__).resolve().parents[2] / "small"


@pytest.mark.parametrize(("kitchen", "doors", "drawers"), [("a", 8, 19), ("b", 3, 14)])
def test_containers_are_those_of_the_paper(sdt, kitchen, doors, drawers) -> None:
    kinds = [each["kind"] for each in sdt("containers", kitchen, "--json").json]
    assert (kinds.count("door"), kinds.count("drawer"), len(kinds)) == (doors, drawers, doors + drawers)


def test_a_handle_is_as_high_as_the_middle_of_its_shapes_in_the_root_frame(sdt) -> None:
    heights = {each["name"]: each["handle_height"] for each in sdt("containers", "a", "--json").json}
    high = {name for name, height in heights.items() if height > 1.2}
    assert high == {"cabinet1_door_top_left", "cabinet4_door_bottom"}
    assert heights["cabinet4_door_bottom"] == pytest.approx(
        1.475, abs=0.001
    )  # the z of its origins, added up


def test_positions_come_with_their_unit(sdt) -> None:
    units = {each["name"]: each["unit"] for each in sdt("containers", "b", "--json").json}
    assert units["iai_fridge_door"] == "rad"
    assert units["sink_area_trash_drawer_main"] == "m"
    (row,) = csv.DictReader(io.StringIO(sdt("causes", "b", "--task", "open:iai_fridge_door", "--csv").out))
    assert row["unit"] == "rad"


@pytest.mark.parametrize(
    "command",
    [
        ("containers", "KITCHEN"),
        ("scope", "KITCHEN"),
        ("scope", "KITCHEN", "--explain"),
        ("causes", "KITCHEN", "--task", "open"),
        ("place", "--kitchen", "KITCHEN", "--robot", "stretch", "--task", "open:none"),
    ],
    ids=" ".join,
)
def test_of_a_kitchen_in_millimetres_every_command_says_so(sdt, tmp_path: Path, command) -> None:
    text = bundled("kitchen", "b").read_text(encoding="utf-8")
    large = re.sub(
        'origin xyz="([^"]*)"',
        lambda found: f'origin xyz="{" ".join(str(1000 * float(each)) for each in found[1].split())}"',
        text,
    )
    path = tmp_path / "large.urdf"
    path.write_text(large, encoding="utf-8")
    done = sdt(*(str(path) if word == "KITCHEN" else word for word in command))
    assert re.search("note: large: joint .*lengths are read in metres, and these may be mil", done.err)


def test_of_a_written_graph_it_is_told_which_are_taken_as_a_kitchen(sdt, tmp_path: Path) -> None:
    for suffix in (".ttl", ".trig", ".nq", ".txt"):
        path = tmp_path / f"g{suffix}"
        if suffix == ".txt":
            path.write_text("", encoding="utf-8")
        else:
            assert sdt("graph", "b", "-o", str(path)).code == 0
        done = sdt("containers", str(path))
        assert done.code == (0 if suffix in {".trig", ".nq"} else 2)
        if suffix in {".ttl", ".txt"}:
            why = {".ttl": "but Turtle does not keep", ".txt": "but its suffix '.txt' is none of these"}[
                suffix
            ]
            assert f"that is a file, {why}" in done.err
            assert ".world, .nq, .trig)" in done.err
    assert "that is a file" not in sdt("containers", str(tmp_path / "gone.ttl")).err
    assert "that is a folder: a bundled name, or the path of a file" in sdt("containers", str(tmp_path)).err


def test_what_is_left_out_is_listed_with_its_reason(sdt) -> None:
    rows = sdt("containers", "a", "--all", "--json").json
    left_out = {each["name"]: each["reason"] for each in rows if each.get("left_out")}
    assert left_out["coffee_table_drawer"] == "it has no handle"
    assert len(left_out) == 11


def test_where_nothing_is_left_out_is_said_so(sdt) -> None:
    done = sdt("containers", str(SMALL / "b.urdf"), "--all")
    assert "no joint that moves is left out" in done.out
    assert "reason" not in done.out


UNNAMED = """
<robot name="n"><link name="frame"/><link name="flap"/><link name="grip"/>
<joint name="hinge" type="revolute"><parent link="frame"/><child link="flap"/><axis xyz="0 0 1"/>
<limit lower="0" upper="1.5" velocity="1" effort="1"/></joint>
<joint name="screw" type="fixed"><parent link="flap"/><child link="grip"/></joint></robot>
"""


@pytest.mark.parametrize(
    "command",
    [
        "achieve --kitchen n.urdf --robot stretch --task open",
        "causes n.urdf --task open",
        "scope n.urdf",
        "scope n.urdf --json",
        "table --kitchens n.urdf --robots stretch",
        "sweep --kitchens n.urdf --robots stretch",
        "codesign --kitchens n.urdf --robots stretch",
        "whatif --kitchen n.urdf --robot stretch --task open --edit drive:fixed",
        "report codesign -p kitchen=n.urdf",
    ],
)
def test_a_kitchen_where_nothing_counts_is_told_with_where_to_look(
    sdt, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, command: str
) -> None:
    monkeypatch.chdir(tmp_path)
    Path("n.urdf").write_text(UNNAMED)
    failed = sdt(*command.split())
    assert failed.code == 2
    assert "kitchen 'n' has no door or drawer that counts" in failed.err
    assert "--all says what is left out, and why" in sdt("containers", "n.urdf").err
    (row,) = sdt("containers", "n.urdf", "--all", "--json").json
    assert row["joint"] == "hinge"
    assert "'flap' is called neither door nor drawer" in row["reason"]


def test_a_limit_without_end_is_null_in_json(sdt, tmp_path: Path) -> None:
    path = tmp_path / "free.urdf"
    path.write_text(
        '<robot name="r"><link name="l"/><link name="drawer"/><link name="handle"/>'
        '<joint name="h" type="fixed"><parent link="drawer"/><child link="handle"/></joint>'
        '<joint name="j" type="prismatic"><parent link="l"/><child link="drawer"/>'
        '<limit lower="0" upper="0.4" effort="1"/></joint></robot>'
    )
    done = sdt("containers", str(path), "--json")
    assert "Infinity" not in done.out
    assert [(each["upper"], each["velocity"]) for each in done.json] == [(0.4, None)]


@pytest.mark.parametrize("suffix", [".ttl", ".trig", ".nq"])
def test_graph_writes_rdf_that_others_read(sdt, tmp_path: Path, suffix: str) -> None:
    path = tmp_path / f"b{suffix}"
    assert sdt("graph", "b", "--robot", "stretch", "-o", str(path)).code == 0
    graph = rdflib.Graph() if suffix == ".ttl" else rdflib.Dataset(default_union=True)
    graph.parse(data=path.read_text(), format={".ttl": "turtle", ".trig": "trig", ".nq": "nquads"}[suffix])
    containers = set(graph.subjects(rdflib.RDF.type, rdflib.URIRef("https://example.org/sdt#Container")))
    assert len(containers) == 17
    assert not [
        term
        for triple in graph.triples((None, None, None))
        for term in triple
        if isinstance(term, rdflib.BNode)
    ]
    rows = sdt("query", str(path), "--json", "SELECT ?d WHERE { ?d a sdt:Door } ORDER BY ?d").json
    assert [row["d"].rsplit("/", 1)[-1] for row in rows] == [
        "iai_fridge_door",
        "oven_area_oven_door",
        "sink_area_dish_washer_door",
    ]


def test_a_kitchen_of_the_paper_is_in_scope(sdt) -> None:
    done = sdt("scope", "b", "--robot", "pr2", "--json")
    assert done.code == 0
    assert done.json["in_scope"] is True


def test_an_open_door_meets_open_and_no_longer_close(sdt) -> None:
    rows = sdt("satisfies", "b", "--state", "iai_fridge_door=open", "--json").json
    assert [each["task"] for each in rows if each["container"] == "iai_fridge_door"] == ["open"]
    assert len(rows) == 17


def test_half_open_meets_neither(sdt) -> None:
    assert sdt("satisfies", "b", "--state", "all=half-open:7", "--json").json == []


def test_causes_makes_a_motion_and_judges_it_again(sdt, tmp_path: Path) -> None:
    path = str(tmp_path / "open.npz")
    door = "open:iai_fridge_door"
    (made,) = sdt("causes", "b", "--task", door, "--motion-out", path, "--json").json
    (judged,) = sdt("causes", "b", "--task", door, "--motion", path, "--json").json
    assert made["outcome"] == judged["outcome"] == "causes"
    assert made["end"] == judged["end"] >= 0.9 * 1.57079632679


def test_a_motion_takes_as_long_whatever_its_clock_says(sdt, tmp_path: Path) -> None:
    path = tmp_path / "recorded.csv"
    path.write_text("# joint: iai_fridge_door_joint\ntime,value\n1700000000,0\n1700000006,1.5\n")
    (judged,) = sdt("causes", "b", "--task", "open:iai_fridge_door", "--motion", str(path), "--json").json
    assert (judged["outcome"], judged["duration"]) == ("causes", 6.0)


def test_what_is_open_cannot_be_caused_to_open(sdt) -> None:
    done = sdt("causes", "b", "--task", "open:iai_fridge_door", "--state", "iai_fridge_door=open", "--json")
    assert done.code == 1
    (diagnosis,) = done.json[0]["diagnoses"]
    assert diagnosis["kind"] == "causal"
    assert "nothing to cause" in diagnosis["reason"]


def test_a_motion_beyond_the_limit_is_refused_with_its_evidence(sdt, tmp_path: Path) -> None:
    times = np.linspace(0.0, 4.0, 41)
    path = tmp_path / "far.npz"
    np.savez(
        path, joint="iai_fridge_door_joint", times=times, values=2.0 * (1 - np.cos(np.pi * times / 4)) / 2
    )
    done = sdt("causes", "b", "--task", "open:iai_fridge_door", "--motion", str(path), "--json")
    assert done.code == 1
    quantities = {each["evidence"]["quantity"] for each in done.json[0]["diagnoses"]}
    assert "position" in quantities


def test_a_motion_of_another_container_or_too_short_does_not_cause_the_task(sdt, tmp_path: Path) -> None:
    times, path = np.linspace(0.0, 4.0, 41), tmp_path / "ajar.npz"
    np.savez(path, joint="iai_fridge_door_joint", times=times, values=0.35 * (1 - np.cos(np.pi * times / 4)))
    for container, reason in (
        ("iai_fridge_door", "iai_fridge_door ends at 0.7 rad: open begins at 1.414 rad"),
        ("sink_area_trash_drawer_main", "sink_area_trash_drawer_main ends at 0 m: open begins at 0.432 m"),
    ):
        done = sdt("causes", "b", "--task", f"open:{container}", "--motion", str(path), "--json")
        ((row,), (diagnosis,)) = done.json, done.json[0]["diagnoses"]
        assert (done.code, row["outcome"], row["container"]) == (1, "does_not_cause", container)
        assert (diagnosis["kind"], diagnosis["reason"]) == ("semantic", reason)


@pytest.mark.parametrize("known", ["kind=sdt:Door", f"kind=<{SDT}Door>", "?kind=sdt:Door"])
def test_a_query_is_asked_about_what_is_known(sdt, known: str) -> None:
    count = "SELECT (COUNT(?c) AS ?n) { ?c a ?kind FILTER(?kind IN (sdt:Door, sdt:Drawer)) }"
    assert sdt("query", "b", count, "--known", known, "--json").json == [{"n": 3}]


@pytest.mark.parametrize("known", ["kind", "kind=", "=sdt:Door", "kind=<no iri>", "other=sdt:Door"])
def test_what_is_nothing_known_is_refused(sdt, known: str) -> None:
    assert sdt("query", "b", "SELECT ?c { ?c a ?kind }", "--known", known).code == 2


def test_query_prints_csv(sdt) -> None:
    done = sdt(
        "query",
        "b",
        "--csv",
        "SELECT ?d ?u WHERE { ?d a sdt:Door ; sdt:hasJoint/sdt:upperLimit ?u } ORDER BY ?d",
    )
    rows = list(csv.DictReader(io.StringIO(done.out)))
    assert [row["d"].rsplit("/", 1)[-1] for row in rows] == [
        "iai_fridge_door",
        "oven_area_oven_door",
        "sink_area_dish_washer_door",
    ]


def test_an_interrupt_ends_a_query_that_would_take_for_ever() -> None:
    query = "SELECT (COUNT(*) AS ?n) { ?a ?b ?c . ?d ?e ?f . ?g ?h ?i }"
    command = [sys.executable, "-m", "services.cli", "query", "b", query]
    process = subprocess.Popen(command, preexec_fn=heard)  # noqa: PLW1509 - one call of the system
    try:
        time.sleep(2.5)  # the query has begun; where it has not, an interrupt ends this as well
        process.send_signal(signal.SIGINT)
        assert process.wait(timeout=20) in {-signal.SIGINT, 130}
    finally:
        process.kill()


def test_a_portable_graph_opens_elsewhere_and_tells_no_folder(sdt, tmp_path, monkeypatch) -> None:
    monkeypatch.delenv("SDT_MODELS", raising=False)
    (tmp_path / "maker" / "meshes").mkdir(parents=True)
    (tmp_path / "maker" / "meshes" / "m.stl").write_bytes(b"solid")
    mesh = '<collision><geometry><mesh filename="meshes/m.stl"/></geometry></collision>'
    urdf = tmp_path / "maker" / "k.urdf"
    urdf.write_text(f'<robot name="k"><link name="wall">{mesh}</link></robot>', encoding="utf-8")
    path = tmp_path / "sent" / "k.trig"
    path.parent.mkdir()
    assert sdt("graph", str(urdf), "--portable", "-o", str(path)).code == 0
    assert "<package://maker/meshes/m.stl>" in path.read_text(encoding="utf-8")
    assert str(tmp_path) not in path.read_text(encoding="utf-8")
    refused = sdt("containers", str(path))
    assert refused.code == 2
    assert "is not there" in refused.err
    assert "SDT_MODELS" in refused.err
    (tmp_path / "maker" / "meshes").rename(tmp_path / "sent" / "meshes")
    assert sdt("containers", str(path)).code == 0
