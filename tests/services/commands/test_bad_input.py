"""Bad input: exit 2, one line that says what, what is allowed or what to do, and no traceback."""

from pathlib import Path

import numpy as np
import pytest

from services.store.files import opened

WHATIF = ("whatif", "--kitchen", "b", "--robot", "pr2", "--task", "open:iai_fridge_door", "--edit")
BAD = {
    "unknown kitchen": (["containers", "kitchn"], ["kitchn", "a, b"]),
    "unknown file": (["containers", "no/such.urdf"], ["no/such.urdf"]),
    "unknown robot": (["graph", "b", "--robot", "pr3", "-o", "x.ttl"], ["pr3", "pr2"]),
    "unknown container": (["causes", "b", "--task", "open:iai_frige"], ["iai_frige", "iai_fridge_door"]),
    "left-out container": (["causes", "a", "--task", "open:coffee_table_drawer"], ["no handle"]),
    "container left empty": (["causes", "b", "--task", "open:"], ["'open:'", "open:CONTAINER"]),
    "unknown verb": (["causes", "b", "--task", "opn"], ["opn", "open"]),
    "container without verb": (
        ["causes", "b", "--task", "iai_fridge_door"], ["did you mean open:iai_fridge_door?"],
    ),
    "verb without colon": (
        ["causes", "b", "--task", "close iai_fridge_door"], ["did you mean close:iai_fridge_door?"],
    ),
    "names in capitals": (["graph", "b", "--robot", "PR2", "-o", "x.ttl"], ["did you mean 'pr2'?"]),
    "box without place": (
        [*WHATIF, "box:crate=1,1"],
        ["'1,1' has not the numbers", "allowed: 3 finite numbers", "as in box:NAME=SX,SY,SZ@X,Y,Z[,YAW]"],
    ),
    "limit that no joint has": (
        [
            *WHATIF,
            "set:iai_fridge_door_joint.upperLimits=1",
        ],
        ["no limit of a joint named 'upperLimits'", "did you mean 'upperLimit'"],
    ),
    "unknown joint": (["satisfies", "b", "--state", "iai_fridge_dor=1"], ["iai_fridge_door"]),
    "state outside limits": (["satisfies", "b", "--state", "iai_fridge_door=2"], ["iai_fridge_door", "1.57"]),
    "state that is no number": (["satisfies", "b", "--state", "iai_fridge_door_joint=wide"], ["wide"]),
    "state that is nan": (["satisfies", "b", "--state", "iai_fridge_door_joint=nan"], ["nan"]),
    "state without value": (["satisfies", "b", "--state", "iai_fridge_door"], ["JOINT=VALUE"]),
    "unknown graph format": (["graph", "b", "-o", "x.json"], ["x.json", ".ttl"]),
    "table into no folder": (["table", "--csv", "gone/table.csv"], ["--csv", "no folder 'gone'"]),
    "grid into no folder": (["whatif", "--csv", "gone/grid.csv"], ["--csv", "no folder 'gone'"]),
    "covers into no folder": (["codesign", "--csv", "gone/covers.csv"], ["--csv", "no folder 'gone'"]),
    "rows into no folder": (["sweep", "--parquet", "gone/rows.parquet"], ["--parquet", "no folder 'gone'"]),
    "motion into no folder": (
        ["causes", "b", "--task", "open", "--motion-out", "gone/x.npz"], ["--motion-out", "no folder 'gone'"],
    ),
    "motion of no known format": (
        ["achieve", "--kitchen", "b", "--robot", "pr2", "--task", "open", "--motion-out", "x.txt"],
        ["x.txt", ".npz, .json, .csv"],
    ),
    "many motions into one file": (
        ["achieve", "--kitchen", "b", "--robot", "pr2", "--task", "open", "--motion-out", "x.npz"],
        ["--motion-out takes one verdict", "open:CONTAINER"],
    ),
    "query that is no query": (["query", "b", "SELEKT"], ["SPARQL"]),
    "update": (["query", "b", "INSERT DATA { <a:a> <a:b> <a:c> }"], ["SELECT"]),
    "service": (["query", "b", "SELECT * { SERVICE <http://127.0.0.1:1/> { ?a ?b ?c } }"], ["SERVICE"]),
    "dataset": (["query", "b", "SELECT * FROM <file:///etc/passwd> { ?a ?b ?c }"], ["leave FROM out"]),
    "load": (["query", "b", "LOAD <http://127.0.0.1:1/>"], ["SELECT"]),
    "no text": (["query", "b", "ASK {} #\udcff"], ["bytes that are no text", "UTF-8"]),
    "no query": (["query", "b"], ["-f FILE.rq"]),
    "no such store": (["query", "gone.trig", "ASK { ?a ?b ?c }"], ["gone.trig"]),
    "base that is no pose": (
        ["achieve", "--kitchen", "b", "--robot", "pr2", "--task", "open", "--base", "1,2"], ["X,Y,YAW"],
    ),
    "base beyond the floor": (
        ["achieve", "--kitchen", "b", "--robot", "pr2", "--task", "open", "--base", "0,60,0"],
        ["the base starts at y = 60 m", "from -50 to 50, where the kitchen's floor ends"],
    ),
    "motion in a folder that is no bag": (
        ["achieve", "--kitchen", "b", "--robot", "pr2", "--task", "open", "--motion", "."],
        ["the folder . is no ROS 2 bag: it has no metadata.yaml", "allowed: .npz, .json, .csv, .mcap or"],
    ),
    "track in a folder that is no bag": (
        ["learn", ".", "--kitchen", "b", "--container", "iai_fridge_door"],
        ["the folder . is no ROS 2 bag: it has no metadata.yaml", "allowed: .log, .txt, .csv"],
    ),
    "kitchen twice": (["table", "--kitchens", "a,a"], ["share a name"]),
    "store that is not there": (
        ["query", "verdict", "ASK {}"],
        ["no kitchen or store named 'verdict'", "or a store that is there (a directory, .trig, .nq)"],
    ),
    "a state between open and closed": (
        ["satisfies", "b", "--state", "iai_fridge_door=half"],
        ["'iai_fridge_door=half' has no number; allowed: a position in rad or m, or of a container open or"],
    ),
    "a state of what is not there": (
        ["satisfies", "b", "--state", "nope=open"],
        ["no joint or container named 'nope'", "sdt containers lists the containers of kitchen b"],
    ),
    "kitchen without a name": (["table", "--kitchens", "b,,a"], ["no kitchen named ''"]),
    "kitchen that is a folder": (["sweep", "--kitchens", "/"], ["no kitchen named '/'"]),
    "state of no kitchen": (["table", "--kitchens", "b", "--state", "nothing=1"], ["nothing=1"]),
    "unknown option": (["containers", "b", "--jason"], ["--jason"]),
    "oracles without a bus": (["serve", "--kitchen", "b", "--oracles"], ["--oracles", "without --bus"]),
    "CSV of no grid": (["whatif", "--csv", "x.csv", "--turn"], ["--csv is of a grid", "--grid"]),
    "a state of a query on the bus": (
        ["ask", "b", "select", "SELECT * { ?a ?b ?c }", "--state", "iai_fridge_door=open"],
        ["--state says nothing to select", "satisfies, causes"],
    ),
    "a drive of a place on the bus": (
        ["ask", "b", "place", "open:iai_fridge_door", "--drive", "omni"], ["--drive says nothing to place"],
    ),
    "a text for a verb on the bus that takes none": (
        ["ask", "b", "satisfies", "iai_fridge_door=open"], ["'iai_fridge_door=open' says nothing to"],
    ),
    "one robot named twice": (
        ("achieve", "--kitchen", "b", "--robot", "pr2", "--robot", "stretch", "--task", "open"),
        ["--robot is given 2 times, and achieve takes one"],
    ),
    "a joint set twice": (
        ["satisfies", "b", "--state", "iai_fridge_door=0.1", "--state", "iai_fridge_door=0.2"],
        ["--state", "iai_fridge_door is given 2 times", "one value"],
    ),
    "a place that is no store's": (
        ["table", "--save", "ftp://x"],
        ["'ftp://x' is no place", "FILE.trig, FILE.nq, a directory, http://HOST"],
    ),
    "a place in no folder": (
        ["sweep", "--plan", "--save", "gone/verdicts"], ["gone/verdicts", "in a folder that is there"],
    ),
    "a place that is an empty variable": (
        ["table", "--save", ""], ["'' is no place for verdicts", "FILE.trig"],
    ),
    "an empty place of one verdict": (
        ["achieve", "--kitchen", "b", "--robot", "pr2", "--task", "open", "--save", ""], ["'' is no place"],
    ),
    "an empty place of a task": (
        ["task", "dishwasher_then_drawer", "--kitchen", "a", "--robot", "pr2", "--save", ""],
        ["'' is no place"],
    ),
    "an empty place of a sweep": (["sweep", "--plan", "--save", ""], ["'' is no place"]),
    "an empty place of a service": (["serve", "--http", "127.0.0.1:0", "--store", ""], ["'' is no place"]),
    "an empty place of a report": (
        ["report", "feasibility", "--store", ""], ["'' is no place", "leave --store out"],
    ),
    "an empty place of what is computed": (
        ["query", "", "--kitchen", "b", "--compute", "ASK { ?v law:outcome law:Certified }"],
        ["'' is no place"],
    ),
    "an empty place of what is read": (["recheck", ""], ["no file or store at ''"]),
    "an empty place of a verdict": (["recheck", "verdict", "--store", ""], ["no file or store at ''"]),
    "a place where nothing is": (
        ["diff", "b", "gone.trig"], ["no file or store at gone.trig; allowed: a .trig or .nq file"],
    ),
    "an empty track": (["learn", ""], ["TRACK", "an empty path"]),
    "an empty file of a report": (["report", "feasibility", "-o", ""], ["-o", "an empty path"]),
    "file left out": (["table", "--csv", "--json"], ["--csv is followed by --json", "FILE", "./--json"]),
    "file left out before a short option": (["graph", "b", "-o", "-o", "x.ttl"], ["-o/--output", "by -o"]),
    "file left out before the help": (["learn", "x.csv", "-o", "-h"], ["-o/--output is followed by -h"]),
    "store left out": (["table", "--save", "--jobs", "1"], ["--save/--store is followed by --jobs"]),
    "file of a setting left out": (["config", "init", "-o", "--force"], ["-o/--output", "by --force"]),
}  # fmt: skip


@pytest.mark.parametrize("name", BAD)
def test_bad_input_is_named(sdt, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, name: str) -> None:
    monkeypatch.chdir(tmp_path)
    arguments, fragments = BAD[name]
    done = sdt(*arguments)
    assert done.code == 2, done
    assert "Traceback" not in done.err
    assert [fragment for fragment in fragments if fragment not in done.err] == []
    assert list(tmp_path.iterdir()) == []


def test_a_store_without_a_verdict_has_nothing_to_recheck(sdt, tmp_path: Path) -> None:
    opened(str(tmp_path / "empty")).close()
    done = sdt("recheck", str(tmp_path / "empty"))
    assert (done.code, done.err) == (
        2,
        f"error: no verdict in {tmp_path / 'empty'}; sdt open tells what is there\n",
    )


def test_a_file_that_is_named_like_an_option_is_written_where_its_path_says_so(
    sdt, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    assert sdt("config", "init", "-o", "./--json").code == 0
    assert [each.name for each in tmp_path.iterdir()] == ["--json"]


URDF = '<robot name="r"><link name="l"/>{}</robot>'
JOINT = URDF.format(
    '<link name="m"/><joint name="j" type="revolute"><parent link="l"/><child link="m"/><origin xyz="{xyz}"/>'
    '<axis xyz="{axis}"/><limit lower="{lower}" upper="1" effort="1" velocity="1"/></joint>'
)
COLLISION = '<collision><geometry><mesh filename="{}"/></geometry></collision>'
MESH = f'<robot name="r"><link name="l">{COLLISION}</link></robot>'
BOMB = '<!DOCTYPE r [<!ENTITY a "aaaa"><!ENTITY b "&a;&a;">]><robot name="&b;"><link name="l"/></robot>'
BAD_URDF = {
    "not XML": ("<robot", ["XML"]),
    "XML bomb": (BOMB, ["DTD"]),
    "duplicate link": (URDF.format('<link name="l"/>'), ["'l'"]),
    "missing mesh": (MESH.format("gone.stl"), ["gone.stl"]),
    "mesh outside": (MESH.format("../../etc/x.stl"), ["x.stl"]),
    "zero axis": (JOINT.format(xyz="0 0 0", axis="0 0 0", lower=0), ["'j'", "axis"]),
    "pose out of this world": (
        JOINT.format(xyz="1e200 0 0", axis="0 0 1", lower=0),
        ["1e200", "up to 1e+06"],
    ),
    "mimic out of this world": (
        JOINT.format(xyz="0 0 0", axis="0 0 1", lower=0).replace(
            "/></joint>", '/><mimic joint="k" multiplier="-1e300"/></joint>'
        ),
        ["-1e300", "up to 1e+06"],
    ),
    "inverted limits": (JOINT.format(xyz="0 0 0", axis="0 0 1", lower=2), ["'j'", "limit"]),
    "NaN": (JOINT.format(xyz="nan 0 0", axis="0 0 1", lower=0), ["'j'", "nan"]),
    "loop": (
        URDF.format(
            '<link name="m"/><joint name="i" type="fixed"><parent link="l"/><child link="m"/></joint>'
            '<joint name="j" type="fixed"><parent link="m"/><child link="l"/></joint>'
        ),
        [],
    ),
}


@pytest.mark.parametrize("name", BAD_URDF)
def test_a_bad_model_is_named(sdt, tmp_path: Path, name: str) -> None:
    text, fragments = BAD_URDF[name]
    path = tmp_path / "bad.urdf"
    path.write_text(text)
    done = sdt("containers", str(path))
    assert done.code == 2, done
    assert "Traceback" not in done.err
    assert [fragment for fragment in ["bad.urdf", *fragments] if fragment not in done.err] == []


DOOR = "iai_fridge_door_joint"
BAD_MOTION = {
    "unsorted times": ({"joint": DOOR, "times": [0.0, 2.0, 1.0], "values": [0.0, 0.1, 0.2]}, ["times", "2"]),
    "not a number": ({"joint": DOOR, "times": [0.0, 1.0], "values": [0.0, np.nan]}, ["values"]),
    "unknown joint": ({"joint": DOOR[1:], "times": [0.0, 1.0], "values": [0.0, 1.0]}, [DOOR]),
    "degrees": ({"joint": DOOR, "times": [0.0, 90.0], "values": [0.0, 90.0]}, ["degree"]),
    "a robot's": ({"base": np.zeros((2, 3)), "times": [0.0, 1.0], "robot": "pr2", "robot_joint_names": ["x"],
        "robot_positions": np.zeros((2, 1))}, ["robot's motion", "'joint'", "sdt achieve --robot"]),
    "wrong arrays": ({"times": [0.0, 1.0]}, ["joint"]),
}  # fmt: skip


@pytest.mark.parametrize("name", BAD_MOTION)
def test_a_bad_motion_is_named(sdt, tmp_path: Path, name: str) -> None:
    arrays, fragments = BAD_MOTION[name]
    path = tmp_path / "motion.npz"
    np.savez(path, **arrays)
    done = sdt("causes", "b", "--task", "open:iai_fridge_door", "--motion", str(path))
    assert done.code == 2, done
    assert "Traceback" not in done.err
    assert [fragment for fragment in fragments if fragment not in done.err] == []


@pytest.mark.parametrize("command", ["recheck", "why", "open"])
def test_an_empty_place_is_not_the_folder_where_the_command_is_run(
    sdt, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, command: str
) -> None:
    opened(tmp_path).close()
    monkeypatch.chdir(tmp_path)
    done = sdt(command, "")
    assert done.code == 2, done
    assert "''" in done.err
