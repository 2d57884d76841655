"""What may never end is not read, and no pipe that nobody reads is written to: an error says so at once."""

import os
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import pytest

from sdt_kg.endless import check_ends
from sdt_kg.errors import InputError
from services.bags import bag_at
from services.store.output import write_file
from tests.services.conftest import Done

B = ["--kitchen", "b", "--robot", "stretch", "--task", "open:iai_fridge_door"]
READ = {
    "a.json": ["achieve", *B, "--motion"],
    "a.csv": ["causes", "b", "--task", "open:iai_fridge_door", "--motion"],
    "a.npz": ["achieve", *B, "--motion"],
    "a.mcap": ["achieve", *B, "--motion"],
    "a.ttl": ["achieve", *B, "--tee", "d_artic_dyn", "--forces"],
    "a.toml": ["--config"],
    "a.rq": ["query", "b", "-f"],
    "b.csv": ["learn"],
    "b.npz": ["learn"],
    "b.mcap": ["learn"],
    "a.patch": ["patch", "-o", "x.trig", "--"],
    "c.csv": ["sweep", "--kitchens", "b", "--robots", "stretch", "--cases"],
    "a.trig": ["open"],
    "b.nq": ["why"],
    "d.trig": ["achieve", *B, "--save"],
    "e.trig": ["branch", "b", "move:iai_fridge_door=open", "--history"],
    "f.nq": ["diff", "b"],
}
LAST = {"a.toml": ["containers", "b"], "a.rq": [], "a.patch": ["b"]}


@pytest.fixture(autouse=True)
def _within(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.chdir(tmp_path)


@pytest.mark.parametrize("name", READ)
def test_a_pipe_is_not_waited_for(sdt: Callable[..., Done], name: str) -> None:
    os.mkfifo(name)
    done = sdt(*READ[name], name, *LAST.get(name, []))
    assert done.code == 2
    assert f"{name} is a pipe or a device, which may never end; allowed: a file; write" in done.err


def test_a_pipe_is_no_store_that_is_well(sdt: Callable[..., Done]) -> None:
    os.mkfifo("a.trig")
    done = sdt("doctor", "--store", "a.trig", "--json")
    assert done.code == 1
    assert "a.trig is a pipe or a device" in done.out


@pytest.mark.parametrize("name", ["metadata.yaml", "bag_0.mcap"])
def test_a_pipe_in_the_folder_of_a_bag_neither(tmp_path: Path, name: str) -> None:
    os.mkfifo(tmp_path / name)
    with pytest.raises(InputError, match="is a pipe or a device"):
        bag_at(tmp_path)


def test_devices_do_not_end_but_for_that_which_has_nothing() -> None:
    with pytest.raises(InputError, match="/dev/zero is a pipe or a device"):
        check_ends(Path("/dev/zero"))
    for each in (os.devnull, "/dev", __file__, "not there", "no\0name"):
        check_ends(Path(each))


def test_a_pipe_that_nobody_reads_is_not_written_to(tmp_path: Path) -> None:
    os.mkfifo(tmp_path / "a")
    with pytest.raises(InputError, match=r"cannot write .*/a: "):
        write_file(tmp_path / "a", "text")


def test_a_pipe_that_somebody_reads_gets_all(tmp_path: Path) -> None:
    os.mkfifo(tmp_path / "a")
    read = "import sys; print(len(open(sys.argv[1]).read()))"
    held = os.open(tmp_path / "a", os.O_RDWR)  # until the reader has opened it too
    with subprocess.Popen([sys.executable, "-c", read, "a"], stdout=subprocess.PIPE) as reader:
        write_file(tmp_path / "a", "a" * 2**20)
        os.close(held)
        assert reader.communicate()[0] == b"1048576\n"


def test_links_that_lead_in_a_circle_are_no_place(sdt: Callable[..., Done], tmp_path: Path) -> None:
    Path("a").symlink_to("b")
    Path("b").symlink_to("a")
    done = sdt("achieve", *B, "--certificate", "a")
    assert (done.code, done.out) == (2, "")
    assert "error: cannot write a: too many levels of symbolic links; " in done.err
    with pytest.raises(InputError, match="too many levels"):
        write_file(tmp_path / "a", "text")


def test_a_pipe_that_the_shell_has_opened_is_read() -> None:
    ends = os.pipe()
    check_ends(Path(f"/dev/fd/{ends[0]}"))
    for each in ends:
        os.close(each)
