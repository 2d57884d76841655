"""The wheel holds every data file and works from an empty directory."""

import json
import os
import shutil
import subprocess
import sys
import zipfile
from pathlib import Path

import pytest

PROJECT = Path(__file__).resolve().parent.parent
PACKAGES = ("ontology", "sdt_kg", "predicates", "services", "kitchens", "robots")
SDT = "from services.cli import main; main()"


@pytest.fixture(scope="module")
def installed(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Folder into which a freshly built wheel is unpacked, with such machine code as was compiled before."""
    out = tmp_path_factory.mktemp("wheel")
    subprocess.run(
        [sys.executable, "-m", "hatchling", "build", "-t", "wheel", "-d", str(out)], cwd=PROJECT, check=True
    )
    (wheel,) = out.glob("sdt_kg-*.whl")
    zipfile.ZipFile(wheel).extractall(out / "site")
    for kept in (PROJECT / "services").rglob("*.nbc"):  # found by what is in them, not by where they are
        there = out / "site" / kept.relative_to(PROJECT)
        there.parent.mkdir(exist_ok=True)
        shutil.copy(kept, there)
    return out / "site"


def run(installed: Path, folder: Path, *arguments: str) -> subprocess.CompletedProcess[str]:
    environment = {**os.environ, "PYTHONPATH": str(installed)}
    return subprocess.run(
        [sys.executable, "-c", SDT, *arguments],
        cwd=folder,
        env=environment,
        capture_output=True,
        text=True,
        check=False,
    )


def test_the_wheel_holds_every_data_file(installed: Path) -> None:
    data = {
        path.relative_to(PROJECT)
        for package in PACKAGES
        for path in (PROJECT / package).rglob("*")
        if path.suffix in {".ttl", ".rq", ".urdf", ".md"}
    }
    assert len(data) > 20
    assert [path for path in sorted(data) if not (installed / path).is_file()] == []


def test_the_wheel_works_from_an_empty_directory(installed: Path, tmp_path: Path) -> None:
    done = run(installed, tmp_path, "containers", "b", "--json")
    assert done.returncode == 0, done.stderr
    assert len(json.loads(done.stdout)) == 17
    assert list(tmp_path.iterdir()) == []


def test_the_wheel_certifies_from_an_empty_directory(installed: Path, tmp_path: Path) -> None:
    arguments = ("achieve", "--kitchen", "b", "--robot", "pr2", "--json")
    done = run(installed, tmp_path, *arguments, "--task", "open:sink_area_left_middle_drawer_main")
    assert done.returncode == 0, done.stderr
    assert [each["outcome"] for each in json.loads(done.stdout)] == ["certified"]
