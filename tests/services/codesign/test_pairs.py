"""Two edits that are made at once: one change of the world, and one that is refused as a whole."""

import pytest

from sdt_kg.errors import InputError
from services.app import Service
from services.codesign.smallest.families import made_at_once
from services.whatif import World, changed
from tests.small import small_twin


def test_two_edits_at_once_are_both_made() -> None:
    world = World(Service(small_twin("a", ("pr2",))), "pr2")
    after = changed(world, made_at_once("move:low_drawer=open & box:crate=0.2,0.2,0.2@3,3,0.1")).service.twin
    (one,) = (each for each in after.containers() if each.name == "low_drawer")
    assert after.state[one.joint] >= one.open_from
    assert [each.name for each in after.mechanism(after.environment).bodies if each.name == "crate"] == [
        "crate"
    ]


def test_a_pair_of_which_one_is_no_edit_is_refused() -> None:
    with pytest.raises(InputError):
        made_at_once("move:low_drawer=open & fly:away")
