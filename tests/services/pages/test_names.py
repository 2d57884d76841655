"""Kitchens and containers of any name, on pages."""

from pathlib import Path

from services.http.kitchens import open_kitchens
from services.http.pages.feasibility.asked import asked_about
from tests.small import FOLDER


def test_a_state_may_name_what_has_blanks_in_its_name(tmp_path: Path) -> None:
    file = tmp_path / "Küche 2.urdf"
    text = (FOLDER / "a.urdf").read_text(encoding="utf-8")
    file.write_text(text.replace("low_drawer", "low drawer, Nr. 1"), encoding="utf-8")
    (kitchen,) = open_kitchens((str(file),), ()).values()
    texts = ("low drawer, Nr. 1=open", "side_door= 0.3")
    for fields in ([("state", " ".join(texts))], [("state", each) for each in texts]):
        asked = asked_about(kitchen, fields)
        assert asked.states == texts
        assert asked.twin.state[asked.twin.container("side_door").joint] == 0.3
    assert asked_about(kitchen, [("state", "  ")]).states == ()
