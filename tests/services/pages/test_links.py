"""Where a page leads to the 3D page, it asks there what it is about itself."""

import re
from contextlib import closing
from html import unescape
from pathlib import Path
from urllib.parse import unquote

import pytest

from sdt_kg.iri import local_name
from services.requests import parse_state
from services.store.files import opened
from tests.services.http.conftest import Serve
from tests.services.pages.conftest import PAGE, verdict_link
from tests.small import small_twin

VIEWER = "http://127.0.0.1:1"


def links(page: str, name: str = "tee") -> list[str]:
    """What the links to the 3D page say of the class, or of something else."""
    found = re.findall(rf'class="in-3d" href="{VIEWER}/case\?([^"]*)"', page)
    said = [unquote(each) for link in found for each in unescape(link).split("&")]
    return [each for each in said if each.startswith(f"{name}=")]


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


@pytest.mark.parametrize("state", ["low_drawer=0.123456789", "all=half-open:1"])
def test_each_cell_says_the_state_to_the_last_digit(serve: Serve, state: str) -> None:
    shown = serve(kitchens=("a",), robots=("pr2",), viewer=VIEWER)
    found = links(shown.get(f"/kitchens/a?state={state}", headers=PAGE).text, "state")
    twin = small_twin("a", ("pr2",))
    now, start = parse_state(twin, [state]), twin.state
    assert len(found) > 1
    for each in found:
        said = dict(part.split("=") for part in each.removeprefix("state=").split(","))
        assert {name: float(at) for name, at in said.items()} == {
            local_name(joint): at for joint, at in now.items() if at != start[joint]
        }
