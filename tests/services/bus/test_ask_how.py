"""`sdt ask`: what decides an answer is sent along, a motion too; what a verb does not hear is refused."""

import json
from pathlib import Path

import pytest

from services.bus.client import Connection
from services.bus.server import Server
from services.commands.exits import Exit
from services.motions import read_arrays, write_arrays

CONTAINER = "iai_fridge_door"
CASE = ("--kitchen", "b", "--robot", "pr2", "--task", f"open:{CONTAINER}")


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Where motions are."""
    return tmp_path_factory.mktemp("motions")


@pytest.mark.parametrize("suffix", [".npz", ".json", ".csv"])
def test_a_motion_in_a_file_is_verified_on_the_bus_as_here(
    sdt, bus: tuple[str, Server], folder: Path, suffix: str
) -> None:
    file = folder / f"fridge{suffix}"
    assert sdt("achieve", *CASE, "--motion-out", str(file)).code == Exit.DONE
    there = sdt(
        "ask", "b", "achieve", f"open:{CONTAINER}", "--motion", str(file), "--json", "--connect", bus[0]
    )
    here = sdt("achieve", *CASE, "--motion", str(file), "--json")
    (one,), (other,) = json.loads(there.out), json.loads(here.out)
    assert (there.code, one["outcome"], one["iri"]) == (Exit.DONE, "certified", other["iri"])
    assert "the body motion was given; it was only checked" in one["notes"]


def test_a_motion_that_is_certified_there_is_written_here(sdt, bus: tuple[str, Server], folder: Path) -> None:
    files = folder / "there.npz", folder / "here.npz"
    to = ("--motion-out", str(files[0]), "--connect", bus[0])
    assert sdt("ask", "b", "achieve", f"open:{CONTAINER}", *to).code == Exit.DONE
    assert sdt("achieve", *CASE, "--motion-out", str(files[1])).code == Exit.DONE
    there, here = map(read_arrays, files)
    assert there.keys() == here.keys()
    assert all((there[name] == here[name]).all() for name in here)
    files[0].unlink()
    refused = sdt("ask", "b", "achieve", f"open:{CONTAINER}", "--drive", "fixed", *to)
    assert (refused.code, files[0].exists()) == (Exit.NO, False)
    assert "is not written: no certified motion" in refused.err


def test_too_much_speed_of_a_motion_without_velocities_is_told_there_too(
    sdt, bus: tuple[str, Server], folder: Path
) -> None:
    made, bare = folder / "made.npz", folder / "bare.json"
    assert sdt("achieve", *CASE, "--motion-out", str(made)).code == Exit.DONE
    arrays = {name: value.tolist() for name, value in read_arrays(made).items() if "velocities" not in name}
    bare.write_text(json.dumps(arrays))
    done = sdt("ask", "b", "achieve", f"open:{CONTAINER}", "--motion", str(bare), "--connect", bus[0])
    assert (done.code, "hint: the motion has no velocities" in done.err) == (Exit.NO, True)


def test_causes_hears_a_motion(sdt, bus: tuple[str, Server], folder: Path) -> None:
    file = folder / "short.json"
    file.write_text(json.dumps({"joint": f"{CONTAINER}_joint", "times": [0, 9], "values": [0, 0.5]}))
    done = sdt("ask", "b", "causes", f"open:{CONTAINER}", "--motion", str(file), "--connect", bus[0])
    assert done.code == Exit.NO
    assert "iai_fridge_door ends at 0.5 rad: open begins at" in done.out


def test_what_is_wrong_with_a_motion_names_its_file(sdt, bus: tuple[str, Server], folder: Path) -> None:
    file = folder / "degrees.json"
    file.write_text(json.dumps({"joint": f"{CONTAINER}_joint", "times": [0, 9], "values": [0, 80]}))
    for verb in ("causes", "achieve"):
        done = sdt("ask", "b", verb, f"open:{CONTAINER}", "--motion", str(file), "--connect", bus[0])
        assert done.code == Exit.BAD_INPUT
        assert done.err.startswith("error: degrees.json: 'values' of iai_fridge_door_joint at sample 1")
    file.write_text(json.dumps({"joint": f"{CONTAINER}_joint", "times": [0, 9], "values": [0, 0.5]}))
    other = sdt("ask", "b", "causes", "open:nope", "--motion", str(file), "--connect", bus[0])
    assert other.err.startswith("error: no container named 'nope'")


def test_what_is_asked_of_fingers_and_starts_is_asked_there(
    sdt, bus: tuple[str, Server], folder: Path
) -> None:
    how = ("--friction", "0.3", "--contact-tolerance", "0.001", "--drive", "fixed", "--base", "0.1,-1.0,-1.2")
    there = sdt(
        "ask", "b", "achieve", f"open:{CONTAINER}", *how, "--seed", "1", "--json", "--connect", bus[0]
    )
    here = sdt("achieve", *CASE, *how, "--seed", "1", "--json")
    assert json.loads(there.out)[0]["iri"] == json.loads(here.out)[0]["iri"]


def test_a_motion_may_begin_anywhere_where_that_is_asked(sdt, bus: tuple[str, Server], folder: Path) -> None:
    file = folder / "elsewhere.json"
    assert sdt("achieve", *CASE, "--motion-out", str(file)).code == Exit.DONE
    arrays = {name: value.tolist() for name, value in read_arrays(file).items()}
    arrays["base"] = [[x + 0.05, y, yaw] for x, y, yaw in arrays["base"]]
    file.write_text(json.dumps(arrays))
    asked = ("ask", "b", "achieve", f"open:{CONTAINER}", "--motion", str(file), "--connect", bus[0])
    refused, accepted = sdt(*asked), sdt(*asked, "--any-start")
    assert "starts at 0.05 m and not at 0 m (parked)" in refused.out
    x, y, yaw = arrays["base"][0]
    assert f"hint: --base {x:.6g},{y:.6g},{yaw:.6g} or --any-start has the robot begin" in refused.err
    assert "(parked)" not in accepted.out
    assert "hint" not in accepted.err


@pytest.mark.parametrize(
    ("verb", "option"),
    [("place", ("--base", "0,0,0")), ("satisfies", ("--friction", "0.5")), ("task", ("--any-start",))],
)
def test_an_option_that_a_verb_does_not_hear_is_refused(
    sdt, bus: tuple[str, Server], verb: str, option: tuple[str, ...]
) -> None:
    text = () if verb == "satisfies" else ("open_then_close",)
    done = sdt("ask", "b", verb, *text, *option, "--connect", bus[0])
    assert (done.code, f"{option[0]} says nothing to {verb}" in done.err) == (Exit.BAD_INPUT, True)


def test_a_bag_is_read_and_written_here(sdt, bus: tuple[str, Server], folder: Path) -> None:
    bag, other = folder / "fridge.mcap", folder / "fridge.npz"
    asked = ("ask", "b", "achieve", f"open:{CONTAINER}", "--json", "--connect", bus[0])
    for file in (bag, other):
        assert sdt(*asked, "--motion-out", str(file)).code == Exit.DONE
    here, there = sdt("achieve", *CASE, "--motion", str(bag), "--json"), sdt(*asked, "--motion", str(bag))
    (one,), (same,) = json.loads(there.out), json.loads(here.out)
    assert (there.code, one["outcome"], one["iri"]) == (Exit.DONE, "certified", same["iri"])
    written, whole = read_arrays(bag), read_arrays(other)
    names = [*whole["robot_joint_names"], *whole["kitchen_joint_names"]]
    assert sorted(written["joint_names"]) == sorted(names)
    assert (written["base"].shape, list(written["base_joint"])) == (whole["base"].shape, ["world_T_base"])


def test_what_is_wrong_in_a_bag_is_told_here_or_by_who_has_the_models(
    sdt, bus: tuple[str, Server], folder: Path
) -> None:
    bag = folder / "seen.mcap"
    bag.write_bytes(b"")
    asked = ("ask", "b", "achieve", f"open:{CONTAINER}", "--motion", str(bag), "--connect", bus[0])
    nothing = sdt(*asked)
    assert (nothing.code, "no readable ROS 2 bag" in nothing.err) == (Exit.BAD_INPUT, True)
    arrays = {"times": [0.0, 1.0], "robot_joint_names": ["torso_lift_jint"], "robot_positions": [[0.1]] * 2}
    still = {"robot_velocities": [[0.0]] * 2, "base": [[0.0] * 3] * 2, "base_velocities": [[0.0] * 3] * 2}
    write_arrays(bag, arrays | still)
    there, here = sdt(*asked), sdt("achieve", *CASE, "--motion", str(bag))
    assert (there.code, here.code) == (Exit.BAD_INPUT, Exit.BAD_INPUT)
    assert "torso_lift_jint" in there.err
    assert here.err == there.err


def test_a_file_for_one_motion_is_refused_before_several_verdicts_are_judged(
    sdt, bus: tuple[str, Server], connection: Connection, folder: Path
) -> None:
    verdicts = "SELECT ?v { ?v a law:Verdict }"
    before = len(connection.select(verdicts)[1])
    many = sdt(
        *("ask", "b", "achieve", "open", "--seed", "7", "--connect", bus[0]),
        *("--motion-out", str(folder / "many.npz")),
    )
    said = (
        "error: one verdict is asked for, and there are 17; allowed: open:CONTAINER or close:CONTAINER, and"
    )
    assert (many.code, many.err[: len(said)]) == (Exit.BAD_INPUT, said)
    assert len(connection.select(verdicts)[1]) == before
