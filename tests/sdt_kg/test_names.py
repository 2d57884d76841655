"""Names are told as they are: what cannot be seen in one, a line break say, could forge a verdict."""

from pathlib import Path

import numpy as np
import pyoxigraph as ox
import pytest

from sdt_kg.errors import GraphError, MotionError, UrdfError
from sdt_kg.load import load_twin
from sdt_kg.twin import Twin
from services.motions.files import motion_of

SEEN = ("Schublade für Gläser", "引き出し", "<b>&amp;", " 2")
UNSEEN = ("&#10;certified  open(x)", "&#x9b;31m", "&#x202e;x", "&#x2028;", " ")


def named(drawer: Path, name: str) -> Path:
    text = drawer.read_text(encoding="utf-8")
    drawer.write_text(text.replace("cupboard_drawer", f"cupboard_drawer{name}"), encoding="utf-8")
    return drawer


@pytest.mark.parametrize("name", SEEN)
def test_what_can_be_read_is_a_name(drawer: Path, name: str) -> None:
    assert load_twin(named(drawer, name.replace("<", "&lt;"))).containers()


@pytest.mark.parametrize("name", UNSEEN)
def test_what_cannot_be_seen_is_in_no_name_of_a_model(drawer: Path, name: str) -> None:
    with pytest.raises(UrdfError, match=r"the name 'cupboard_drawer.*' has what cannot be seen"):
        load_twin(named(drawer, name))


def test_nor_in_one_of_a_saved_twin(drawer: Path) -> None:
    saved = load_twin(drawer).serialize("nquads")
    saved = saved.replace(b'"cupboard_drawer"', b'"cupboard_drawer\\n"')
    saved = saved.replace(b"cupboard_drawer", b"cupboard_drawer%0A").replace(b'%0A\\n"', b'\\n"')
    with pytest.raises(GraphError, match="cannot be seen"):
        Twin.from_quads(saved_quads(saved))


def saved_quads(saved: bytes) -> list[ox.Quad]:
    return list(ox.parse(saved, format=ox.RdfFormat.N_QUADS))


@pytest.mark.parametrize("name", ["pr2\ncertified", b"\x1b[2J", "a\u202e"])
def test_nor_in_one_of_a_motion(drawer: Path, name: str | bytes) -> None:
    arrays = {"joint": np.array(name), "times": np.arange(2.0), "values": np.zeros(2)}
    with pytest.raises(MotionError, match=r"'joint' holds '.*; allowed: names without control characters"):
        motion_of(arrays, load_twin(drawer))
