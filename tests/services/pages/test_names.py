"""Kitchens and containers of any name, on pages."""

import html
import re
from pathlib import Path
from urllib.parse import quote

from services.http.kitchens import open_kitchens
from services.http.pages.feasibility.asked import asked_about
from tests.services.http.conftest import Serve, serve
from tests.services.pages.conftest import PAGE
from tests.small import FOLDER

__all__ = ["serve"]
ODD = "low/drawer #1?&%3C;+"


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


def test_links_of_a_page_lead_on_whatever_is_in_a_name(serve: Serve, tmp_path: Path) -> None:
    file = tmp_path / "k #1.urdf"
    text = (FOLDER / "a.urdf").read_text(encoding="utf-8")
    file.write_text(text.replace("low_drawer", html.escape(ODD)), encoding="utf-8")
    served = serve(kitchens=(str(file.with_suffix("")),))
    page = served.get(f"/id/{quote('k #1')}/body/{quote(ODD, safe='')}", headers=PAGE).text
    links = {html.unescape(each) for each in re.findall(r'href="(/[^"]*)"', page)}
    about = {each for each in links if "drawer" in each or "k%20" in each or "k+" in each}
    assert len(about) > 8
    assert {each: served.get(each, headers=PAGE).status_code for each in about} == dict.fromkeys(about, 200)
    (verdicts,) = (each for each in about if each.startswith("/verdicts?container="))
    assert served.get(verdicts, headers=PAGE).text.count(html.escape(ODD)) > 0
