"""Every finding that asks for something says what to do, and the exit code says whether there is one."""

import shutil
from collections.abc import Callable
from pathlib import Path

import pytest

import robots
import services
from sdt_kg.iri import LAW
from services.bus.sessions import open_session
from services.doctor import machine, packages
from services.doctor.finding import Standing
from services.doctor.places import bus, stores
from tests.ports import free_endpoint
from tests.services.conftest import Done

RDF_TYPE = "http://www.w3.org/1999/02/22-rdf-syntax-ns#type"


def test_what_is_missing_is_said_with_what_to_do(sdt: Callable[..., Done], tmp_path: Path) -> None:
    empty = tmp_path / "empty.urdf"
    empty.write_text('<robot name="empty"><link name="l"/></robot>')
    done = sdt("doctor", "--json", "--kitchen", str(empty), "--robot", str(empty), "--store", "gone.trig")
    found = {each["about"]: each for each in done.json["findings"]}
    to_do = {about for about, each in found.items() if each["standing"] == "to do"}
    assert to_do == {f"kitchen {empty}", f"robot {empty}", "store gone.trig"}
    assert (done.code, done.json["well"]) == (1, False)
    assert [about for about, each in found.items() if each["standing"] != "well" and not each["remedy"]] == []
    bundled = ("kitchen a", "kitchen b", "robot pr2", "robot stretch", "robot tiago_dual")
    assert {found[about]["standing"] for about in bundled} == {"well"}
    assert "27 containers" in found["kitchen a"]["says"]
    assert "pin 4" in found["solvers"]["says"]


SLIPS = """<robot name="slips"><link name="world"/>
<link name="low_drawer"><visual><geometry><box size="0.4 0.4 0.2"/></geometry></visual></link>
<joint name="low_drawer_joint" type="prismatic"><parent link="world"/><child link="low_drawer"/>
<origin xyz="1 0 0.5" rpy="0 0 90"/><axis xyz="1 0 0"/>
<limit lower="0" upper="0" velocity="1" effort="1"/></joint>
</robot>
"""


def test_of_models_that_are_named_the_notes_of_the_import_are_told(
    sdt: Callable[..., Done], tmp_path: Path
) -> None:
    slips = tmp_path / "slips.urdf"
    slips.write_text(SLIPS)
    robot = tmp_path / "stretch.urdf"
    there = robots.path("stretch/stretch.urdf")
    head = there.read_text().replace('lower="-1.53" upper="0.79"', 'lower="-90" upper="45"')
    robot.write_text(head)
    shutil.copy(there.with_suffix(".ttl"), tmp_path)
    asked = ("doctor", "--kitchen", str(slips), "--robot", str(robot))
    found = {each["about"]: each for each in sdt(*asked, "--json").json["findings"]}
    told = sdt("containers", str(slips)).err
    notes = found[f"kitchen {slips}"]["notes"]
    assert [f"note: {note}" in told for note in notes] == [True] * len(notes)
    for slip in ("imported as fixed", "may be in degrees", "which nothing can collide with"):
        assert slip in " ".join(notes)
    (of_robot,) = found[f"robot {robot}"]["notes"]
    assert of_robot.startswith("stretch: angles are read in radians, and these may be in degrees")
    assert found["kitchen b"]["notes"] == found["robot pr2"]["notes"] == []
    assert f"note: {notes[0]}" in " ".join(sdt(*asked).out.split())
    rows = sdt(*asked, "--csv").out.splitlines()
    assert any("; ".join(notes) in row for row in rows)


ONE = """<robot name="one"><link name="world"/>
<link name="drawer"><collision><geometry><box size="0.4 0.4 0.2"/></geometry></collision></link>
<joint name="drawer_joint" type="prismatic"><parent link="world"/><child link="drawer"/>
<axis xyz="-1 0 0"/><limit lower="0" upper="0.4" velocity="1" effort="1"/></joint>
<link name="handle"><collision><geometry><box size="0.01 0.15 0.01"/></geometry></collision></link>
<joint name="handle_joint" type="fixed"><parent link="drawer"/><child link="handle"/>
<origin xyz="-0.26 0 0"/></joint></robot>
"""


def test_one_container_is_told_as_one(sdt: Callable[..., Done], tmp_path: Path) -> None:
    one = tmp_path / "one.urdf"
    one.write_text(ONE)
    found = {each["about"]: each for each in sdt("doctor", "--kitchen", str(one), "--json").json["findings"]}
    assert found[f"kitchen {one}"]["says"] == "1 container, 1 in scope of D_artic"
    assert sdt("scope", str(one)).out == "in scope of D_artic: 1 container\n"


def test_missing_extras_are_no_reason_to_do_anything() -> None:
    found = packages.of_extra("ros", [("rosbags", "99")])
    assert (found.standing, found.remedy) == (Standing.OPTIONAL, "pip install 'sdt-kg[ros]'")


@pytest.mark.parametrize(
    ("name", "least", "said"),
    [("numpy", "1.26", ""), ("numpy", "99", "older than 99"), ("not-there", "1", "missing")],
)
def test_a_package_is_missing_too_old_or_right(name: str, least: str, said: str) -> None:
    lacks = packages.lacks(name, least)
    assert said in lacks
    assert bool(lacks) == bool(said)


def test_versions_are_compared_as_numbers() -> None:
    assert packages.numbers("2.10.0rc1") > packages.numbers("2.9")
    assert packages.numbers("5") == packages.numbers("5.0")


def test_every_requirement_is_understood() -> None:
    core, extras = packages.declared()
    assert ("numpy", "2.2") in core
    assert ("viser", "1.1") in extras["view"]
    assert not {"bench", "dev"} & extras.keys()


def test_little_memory_is_something_to_do() -> None:
    found = machine.memory(0.2)
    assert found.standing is Standing.TO_DO
    assert "--jobs 1" in found.remedy


def test_every_module_with_loops_that_are_kept_is_looked_at() -> None:
    root = Path(services.__file__).parent
    keeping = [path for path in root.rglob("*.py") if "\n@kernel" in path.read_text(encoding="utf-8")]
    (loops,) = (each for each in machine.machine() if each.about == "compiled loops")
    assert f" of {len(keeping)} modules with loops " in loops.says


@pytest.mark.parametrize(
    ("missing", "standing"),
    [
        ("services.reports.scene.raster", Standing.WELL),
        ("services.physics.geometry.deepest", Standing.WELL),  # the bundled models have no mesh
        ("services.embodiment.prove.tree.boxes", Standing.OPTIONAL),
    ],
)
def test_only_loops_of_questions_and_proofs_are_missed(
    missing: str, standing: Standing, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(machine, "_compiled", lambda module: module != missing)
    (loops,) = (each for each in machine.machine() if each.about == "compiled loops")
    assert loops.standing is standing
    assert bool(loops.remedy) is (standing is Standing.OPTIONAL)


def test_the_verdicts_of_a_store_are_counted(tmp_path: Path) -> None:
    path = tmp_path / "kept.nq"
    path.write_text(f"<a:a> <{RDF_TYPE}> <{LAW}Verdict> <a:g> .\n")
    (found,) = stores([str(path)])
    assert (found.standing, found.says) == (Standing.WELL, "1 verdict")
    (other,) = stores([__file__])
    assert (other.standing, "FILE.trig" in other.says) == (Standing.TO_DO, True)


def test_nobody_on_the_bus_and_no_bus_are_different() -> None:
    endpoint = free_endpoint()
    (nobody,) = bus(endpoint, None, ["b"])
    assert nobody.standing is Standing.TO_DO
    with open_session(listen=endpoint, mode="router"):
        found = {each.about: each.standing for each in bus(endpoint, None, ["b"])}
    assert found[f"bus {endpoint}"] is Standing.WELL
    assert found["oracle canperform"] is Standing.OPTIONAL
    assert found["server of b"] is Standing.OPTIONAL
