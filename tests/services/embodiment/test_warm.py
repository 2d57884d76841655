"""What workers begin with: after `prepare`, a case compiles nothing any more."""

import importlib
import sys
import time

import numpy as np
import pytest

from sdt_kg.annotation import Drive
from sdt_kg.motion import Motion
from services.app import Policy, Service, load
from services.embodiment.body.demands import Margins
from services.embodiment.body.world import World
from services.embodiment.certify.tolerances import Tolerances
from services.embodiment.hold.kit import Kits
from services.embodiment.oracle import WholeBody
from services.embodiment.prove.tree import boxes
from services.embodiment.search.plan import Planner
from services.embodiment.setting import Setting
from services.embodiment.ways.roads import Known
from services.kernel import is_kernel, worked
from services.physics.model import Scene

pytestmark = pytest.mark.oracle

CERTIFIER = ("services.embodiment.certify.sweep.compiled", "services.embodiment.certify.sweep.telling")
BUDGET, SLOW = 0.5, 0.7  # [s]
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


def prepared() -> Service:
    """As workers have it."""
    service = load("b", ["pr2"], policy=Policy(Drive.OMNI))
    assert isinstance(service.embodiment, WholeBody)
    service.embodiment.prepare(service.twin, service.twin.robots[0])
    return service


@pytest.mark.usefixtures("forgotten")
def test_after_prepare_a_certificate_compiles_nothing() -> None:
    service = prepared()
    before = compiled()
    assert all(before.values()), [name for name, types in before.items() if not types]
    (verdict,) = service.achieve(f"open:{DRAWER}")
    assert verdict.outcome.value == "certified"
    assert compiled() == before


def test_where_no_proof_is_looked_for_its_loops_are_not_compiled(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(boxes, "kept", lambda _: [])
    boxes.divide._reset_overloads()
    (verdict,) = prepared().achieve(f"open:{DRAWER}")
    assert verdict.outcome.value == "certified"
    assert not boxes.divide.signatures


def test_what_compiling_such_loops_costs_leaves_the_search_its_budget(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    twin = load("b", ["stretch"]).twin
    world, container = World(Scene(twin, twin.robots[0])), twin.container(DRAWER)
    motion = Motion(container.joint, np.array([0.0, 1.0]), np.array([[0.0], [container.open_from]]))
    own = Kits(world, Margins()), Known(), Tolerances()
    setting = Setting(world, container, motion, Drive.FIXED, (0.0, 0.0, 0.0), twin.robots[0], *own)
    loading = boxes.divide._cache.load_overload

    def slow(*about: object) -> object:
        began = time.thread_time()
        while time.thread_time() < began + SLOW:
            pass
        return loading(*about)

    monkeypatch.setattr(boxes.divide._cache, "load_overload", slow)
    boxes.divide._reset_overloads()
    planner = Planner(setting, worked() + BUDGET, 0, lambda _step, _since: None)
    spent = time.thread_time()
    planner.proofs.look(1)
    assert boxes.divide.signatures
    assert time.thread_time() - spent > SLOW
    assert not planner.late()
