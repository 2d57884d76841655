"""Small URDF texts."""

from collections.abc import Callable
from pathlib import Path

import pytest

Write = Callable[..., Path]


def link(name: str, *shapes: str) -> str:
    collision = "".join(f"<collision><geometry>{shape}</geometry></collision>" for shape in shapes)
    return f'<link name="{name}">{collision}</link>'


def joint(name: str, kind: str, parent: str, child: str, inside: str = "") -> str:
    ends = f'<parent link="{parent}"/><child link="{child}"/>'
    return f'<joint name="{name}" type="{kind}">{ends}{inside}</joint>'


def limit(lower: float, upper: float, velocity: float = 1.0) -> str:
    return f'<limit lower="{lower!r}" upper="{upper!r}" velocity="{velocity!r}" effort="10"/>'


@pytest.fixture
def write(tmp_path: Path) -> Write:
    """Write a model and give its path."""

    def written(*parts: str, name: str = "k.urdf", head: str = "") -> Path:
        path = tmp_path / name
        path.write_text(
            f'<?xml version="1.0"?>{head}<robot name="k">{"".join(parts)}</robot>', encoding="utf-8"
        )
        return path

    return written


@pytest.fixture
def drawer(write: Write) -> Path:
    """A kitchen of one drawer of 0.5 m with a handle."""
    return write(*DRAWER)


DRAWER = (
    link("world"),
    link("cupboard_drawer", '<box size="0.4 0.5 0.2"/>'),
    link("cupboard_handle", '<box size="0.02 0.1 0.02"/>'),
    joint("slide", "prismatic", "world", "cupboard_drawer", limit(0.0, 0.5)),
    joint("mount", "fixed", "cupboard_drawer", "cupboard_handle", '<origin xyz="0.22 0 0"/>'),
)
