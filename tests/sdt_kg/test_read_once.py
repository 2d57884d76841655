"""A bundled model is read once, as long as its files stay as they are; any other whenever it is asked for."""

import shutil
from pathlib import Path

import pytest

import kitchens
from sdt_kg import load
from sdt_kg.load import load_twin


def test_a_bundled_kitchen_and_its_robots_are_read_once() -> None:
    twin = load_twin("b", ["pr2", "stretch"])
    assert load_twin("b", ("pr2", "stretch")) is twin
    assert load_twin("b", ["stretch", "pr2"]).robots == twin.robots[::-1]
    assert load_twin("b").robots == ()


@pytest.mark.parametrize(
    ("file", "old", "new"),
    [("b.ttl", "sdt:x 0.0", "sdt:x 0.25"), ("b.urdf", 'upper="0.48"', 'upper="0.47"')],
)
def test_it_is_read_anew_when_one_of_its_files_was_changed(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path, file: str, old: str, new: str
) -> None:
    shutil.copytree(kitchens.path("b"), tmp_path / "b")
    monkeypatch.setitem(load._FOLDERS, "kitchen", lambda name: tmp_path / name)
    before = load_twin("b")
    assert load_twin("b") is before
    text = (tmp_path / "b" / file).read_text(encoding="utf-8")
    assert old in text
    (tmp_path / "b" / file).write_text(text.replace(old, new), encoding="utf-8")
    after = load_twin("b")
    assert after.content_hash(after.environment) != before.content_hash(before.environment)


def test_a_model_by_its_path_is_read_whenever_it_is_asked_for(drawer: Path) -> None:
    before = load_twin(drawer)
    text = drawer.read_text(encoding="utf-8")
    drawer.write_text(text.replace('upper="0.5"', 'upper="0.4"'), encoding="utf-8")
    (container,) = load_twin(drawer).containers()
    assert (before.containers()[0].upper, container.upper) == (0.5, 0.4)
