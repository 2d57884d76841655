"""Where a page leads to the 3D page, it asks there what it is about itself."""

import re
from contextlib import closing
from html import unescape
from pathlib import Path

import pytest

from services.store.files import opened
from tests.services.http.conftest import Serve
from tests.services.pages.conftest import PAGE, verdict_link

VIEWER = "http://127.0.0.1:1"


def links(page: str) -> list[str]:
    """What the links to the 3D page say of the class."""
    found = re.findall(rf'class="in-3d" href="{VIEWER}/case\?([^"]*)"', page)
    return [each for link in found for each in unescape(link).split("&") if each.startswith("tee=")]


@pytest.mark.parametrize("tee", ["D_artic", "D_artic_dyn"])
def test_each_cell_names_its_class(serve: Serve, tee: str) -> None:
    shown = serve(kitchens=("a",), robots=("pr2",), viewer=VIEWER)
    found = links(shown.get(f"/kitchens/a?class={tee}", headers=PAGE).text)
    assert len(found) > 1
    assert set(found) == {f"tee={tee}"}


def test_a_verdict_names_its_class(serve: Serve, seed: Path) -> None:
    with closing(opened(seed)) as archive:
        shown = serve(kitchens=("a",), robots=("pr2", "stretch"), archive=archive, viewer=VIEWER)
        page = shown.get(verdict_link(shown, robot="pr2"), headers=PAGE).text
    assert links(page) == ["tee=D_artic"]
