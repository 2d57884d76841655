"""A sample of the random cabinets of `tests/soak/test_random_cabinets.py`."""

from pathlib import Path

from tests.soak.test_random_cabinets import judged


def test_no_container_of_some_passes_through_what_is_in_its_way(tmp_path: Path) -> None:
    judged(range(150), tmp_path)
