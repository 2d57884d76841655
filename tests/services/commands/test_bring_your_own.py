"""The guides for a kitchen and a robot of one's own, followed with the reference's models."""

from collections.abc import Callable
from pathlib import Path

import pytest

from services.cli import sdt as root
from tests.services.conftest import Done

PROJECT = Path(__file__).resolve().parents[3]
GUIDES = [PROJECT / "kitchens" / "README.md", PROJECT / "robots" / "README.md"]


@pytest.mark.parametrize("guide", GUIDES, ids=lambda guide: guide.parent.name)
def test_every_command_of_a_guide_is_one_with_those_options(guide: Path) -> None:
    lines = [
        line.split() for line in guide.read_text(encoding="utf-8").splitlines() if line.startswith("sdt ")
    ]
    assert len(lines) >= 4
    for _, name, *words in lines:
        command = root.commands[name]
        known = {option for each in command.params for option in each.opts} | {"--help"}
        assert [word for word in words if word.startswith("--") and word not in known] == []


@pytest.mark.reference
def test_a_kitchen_of_one_s_own(sdt: Callable[..., Done], reference: Path) -> None:
    kitchen = str(reference / "kitchen_b_iai_kitchen" / "kitchen-small.urdf")
    found = sdt("containers", kitchen, "--all", "--csv")
    assert found.out.count("\n") == 1 + 15 + found.out.count("True")
    assert "oven_area_oven_door_joint': revolute joint with equal limits 0..0: imported as fixed" in (
        sdt("containers", kitchen).err
    )
    assert sdt("scope", kitchen, "--json").json["in_scope"]
    assert sdt("causes", kitchen, "--task", "open:iai_fridge_door").code == 0
