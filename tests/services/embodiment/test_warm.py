"""What workers begin with: after `prepare`, a case compiles nothing any more."""

import importlib
import sys

import pytest

from sdt_kg.annotation import Drive
from services.app import Policy, load
from services.embodiment.oracle import WholeBody
from services.kernel import is_kernel

pytestmark = pytest.mark.oracle

CERTIFIER = ("services.embodiment.certify.sweep.compiled", "services.embodiment.certify.sweep.telling")
DRAWER = "sink_area_left_middle_drawer_main"


def compiled() -> dict[str, list[object]]:
    """Kernel of the certifier → the types that it was made for."""
    kernels = {f"{name}.{key}": value for name in CERTIFIER for key, value in vars(sys.modules[name]).items()}
    return {name: list(value.signatures) for name, value in kernels.items() if is_kernel(value)}


@pytest.fixture
def forgotten() -> None:
    """These kernels as a new process has them."""
    for name in CERTIFIER:
        for value in vars(importlib.import_module(name)).values():
            if is_kernel(value):
                value._reset_overloads()


@pytest.mark.usefixtures("forgotten")
def test_after_prepare_a_certificate_compiles_nothing() -> None:
    service = load("b", ["pr2"], policy=Policy(Drive.OMNI))
    body = service.embodiment
    assert isinstance(body, WholeBody)
    body.prepare(service.twin, service.twin.robots[0])
    before = compiled()
    assert all(before.values()), [name for name, types in before.items() if not types]
    (verdict,) = service.achieve(f"open:{DRAWER}")
    assert verdict.outcome.value == "certified"
    assert compiled() == before
