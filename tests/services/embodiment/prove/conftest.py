"""Fronts that are refuted once for all tests of them."""

import pytest

from sdt_kg.twin import Twin
from services.embodiment.prove import Proved
from tests.services.embodiment.prove.grasping import NEVER_HELD, refuted_grasps


@pytest.fixture(scope="session")
def never(tmp_path_factory: pytest.TempPathFactory) -> tuple[Twin, Proved]:
    """A front that no grasp opens, and the proof."""
    return refuted_grasps(tmp_path_factory.mktemp("front"), NEVER_HELD)
