"""Files as Windows writes them: with a byte order mark, and lines that end with two characters."""

import json
from codecs import BOM_UTF8
from collections.abc import Callable
from pathlib import Path

from tests.services.conftest import Done
from tests.small import FOLDER

KITCHEN = str(FOLDER / "a.urdf")
TASK = """@prefix law: <https://example.org/law#> .
@prefix rdfs: <http://www.w3.org/2000/01/rdf-schema#> .
@prefix t: <https://example.org/id/t/> .
t:task a law:TaskSpecification ; rdfs:label "fetch" ; law:hasStep t:one .
t:one a law:Task ; law:index 1 ; law:verb law:Opn ; law:containerName "low_drawer" .
"""
MOTION = {"joint": "low_drawer_joint", "times": [0.0, 2.0, 4.0, 6.0], "values": [0.0, 0.1, 0.4, 0.48]}


def written(path: Path, text: str) -> str:
    path.write_bytes(BOM_UTF8 + text.replace("\n", "\r\n").encode())
    return str(path)


def test_a_query(sdt: Callable[..., Done], tmp_path: Path) -> None:
    file = written(tmp_path / "doors.rq", "SELECT ?d\n{ ?d a sdt:Door }\n")
    assert len(sdt("query", KITCHEN, "-f", file, "--json").json) == 3
    (tmp_path / "latin.rq").write_bytes(b"SELECT ?d { ?d sdt:name 'T\xfcr' }")
    done = sdt("query", KITCHEN, "-f", str(tmp_path / "latin.rq"))
    assert (done.code, "cannot be read" in done.err) == (2, True)


def test_settings(sdt: Callable[..., Done], tmp_path: Path) -> None:
    file = written(tmp_path / "sdt.toml", "# mine\nseed = 3\n")
    assert "3" in sdt("--config", file, "config", "show").out


def test_a_motion(sdt: Callable[..., Done], tmp_path: Path) -> None:
    file = written(tmp_path / "drawer.json", json.dumps(MOTION))
    assert sdt("causes", KITCHEN, "--task", "open:low_drawer", "--motion", file).code in {0, 1}


def test_a_task_and_an_annotation(sdt: Callable[..., Done], tmp_path: Path) -> None:
    for suffix in ("urdf", "ttl"):
        written(tmp_path / f"pr2.{suffix}", (FOLDER / f"pr2.{suffix}").read_text(encoding="utf-8"))
    task = written(tmp_path / "task.ttl", TASK)
    done = sdt("task", task, "--kitchen", KITCHEN, "--robot", str(tmp_path / "pr2.urdf"))
    assert (done.code, "law#Opn; allowed: law:Open" in done.err) == (2, True), done.err
