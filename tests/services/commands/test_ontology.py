"""`sdt ontology` writes the documentation page."""

from collections.abc import Callable
from pathlib import Path

from services.ontology_page.page import page
from tests.services.conftest import Done


def test_the_page_is_written_or_printed(tmp_path: Path, sdt: Callable[..., Done]) -> None:
    file = tmp_path / "ontology.html"
    assert sdt("ontology", "-o", str(file)).code == 0
    assert file.read_text(encoding="utf-8") == page()
    assert sdt("ontology").out.strip() == page().strip()


def test_a_place_that_cannot_be_written_is_named(tmp_path: Path, sdt: Callable[..., Done]) -> None:
    done = sdt("ontology", "-o", str(tmp_path / "no" / "such.html"))
    assert done.code == 2
    assert f"there is no folder '{tmp_path / 'no'}'" in done.err
