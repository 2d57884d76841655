"""Every numbered example runs, and ends as its page says."""

import asyncio
import importlib.util
from pathlib import Path
from types import ModuleType

import pytest

FOLDER = Path(__file__).resolve().parents[2] / "services" / "examples"


def example(name: str) -> ModuleType:
    spec = importlib.util.spec_from_file_location("example", FOLDER / f"{name}.py")
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


@pytest.mark.oracle
@pytest.mark.slow
def test_a_spoiled_motion_is_refused_repaired_by_its_diagnoses_and_certified() -> None:
    outcomes = asyncio.run(example("01_verify_and_repair").main())
    assert outcomes == ["not_certified", "not_certified", "not_certified", "certified"]
