"""Compiled loops are kept between processes, and never outlive what they were made of."""

import gc
import importlib.util
import multiprocessing
import resource
import subprocess
import sys
import time
from collections.abc import Callable
from pathlib import Path
from types import ModuleType

import pytest
from numba.core.errors import TypingError

from services import compiled
from services.compiled import made_of
from services.kernel import kept, worked

CALLEE = """
import numpy as np

from services.kernel import kernel, subkernel

STEP = {step}

@kernel
def made(x):
    return np.full(2, x)

@{declared}
def inner(x):
    '''Doc{doc}.'''
    return {inner}
"""

CALLER = """
import math

from edited_inner import inner
from services.kernel import kernel

@kernel
def outer(x):
    return _late(inner(x)) + math.floor(0.5)

@kernel
def _late(x):
    return x

@kernel
def several(x):
    return inner(1) + inner(2) + inner(x)
"""

SHARED = "kernel(shared=True)"
ASK = """
from edited_outer import inner, outer
print(outer(1.0), outer.stats.cache_hits.total(), inner.stats.cache_hits.total())
"""

Loader = Callable[..., ModuleType]


@pytest.fixture
def loaded(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Loader:
    """The caller's module as a new process would import it, after its callee was written anew."""
    monkeypatch.setattr(sys, "dont_write_bytecode", True)

    def load(
        inner: str = "x + STEP", step: float = 1.0, doc: str = "", declared: str = "kernel"
    ) -> ModuleType:
        callee = CALLEE.format(inner=inner, step=step, doc=doc, declared=declared)
        (tmp_path / "edited_inner.py").write_text(callee)
        (tmp_path / "edited_outer.py").write_text(CALLER)
        for name in ("edited_inner", "edited_outer"):
            spec = importlib.util.spec_from_file_location(name, tmp_path / f"{name}.py")
            assert spec is not None
            assert spec.loader is not None
            module = importlib.util.module_from_spec(spec)
            monkeypatch.setitem(sys.modules, name, module)
            spec.loader.exec_module(module)
        return sys.modules["edited_outer"]

    return load


def test_what_was_compiled_is_found_again_whatever_the_date_of_the_file_and_its_docstrings(
    loaded: Loader,
) -> None:
    assert loaded().outer(1.0) == 2.0
    again = loaded(doc=" and more")
    assert again.outer(1.0) == 2.0
    assert sum(again.outer.stats.cache_hits.values()) == 1
    assert not again.outer.stats.cache_misses


@pytest.mark.parametrize("declared", ["kernel", "subkernel", SHARED])
def test_an_edit_of_a_callee_in_another_file_compiles_its_callers_anew(loaded: Loader, declared: str) -> None:
    old = loaded(declared=declared)
    assert old.outer(1.0) == 2.0
    edited = loaded(inner="x - STEP", declared=declared)
    assert edited.outer(1.0) == 0.0
    assert not edited.outer.stats.cache_hits


def test_a_subkernel_is_part_of_its_callers_which_are_found_again(loaded: Loader) -> None:
    assert loaded(declared="subkernel").outer(1.0) == 2.0
    again = loaded(declared="subkernel").outer
    assert again(1.0) == 2.0
    assert sum(again.stats.cache_hits.values()) == 1


def test_who_is_compiled_anew_takes_in_what_was_kept_of_the_kernels_that_it_calls(loaded: Loader) -> None:
    old = loaded().outer
    assert old(1.0) == 2.0
    for file in kept(old):
        file.unlink()
    anew = loaded().outer
    assert anew(1.0) == 2.0
    assert not anew.stats.cache_hits
    inner = vars(sys.modules["edited_inner"])["inner"]
    assert sum(inner.stats.cache_hits.values()) == 1
    assert inner(3.0) == 4.0


def test_another_process_finds_a_shared_kernel_with_its_caller_or_compiles_it(loaded: Loader) -> None:
    module = loaded(declared=SHARED)
    assert (module.outer(1.0), module.inner(3.0)) == (2.0, 4.0)
    folder = Path(module.__file__ or "").parent
    for found in (1, 0):  # of the shared kernel, the second time its file is gone
        said = subprocess.run([sys.executable, "-c", ASK], check=True, capture_output=True, cwd=folder)
        assert said.stdout.split() == [b"2.0", b"1", str(found).encode()]
        for file in kept(module.inner):
            file.unlink()


def test_a_subkernel_can_be_called_from_python_before_and_after_its_callers(loaded: Loader) -> None:
    module = loaded(inner="x + x * STEP", declared="subkernel")
    assert (module.inner(2.0), module.outer(2.0), module.inner(2.0)) == (4.0, 4.0, 4.0)


@pytest.mark.parametrize("declared", ["subkernel", SHARED])
def test_an_error_in_what_kernels_call_is_raised_from_its_caller(loaded: Loader, declared: str) -> None:
    module = loaded(inner="STEP / x", declared=declared)
    assert module.outer(2.0) == 0.5
    for outer in (module.outer, loaded(inner="STEP / x", declared=declared).outer):
        with pytest.raises(ZeroDivisionError):
            outer(0.0)


def test_a_subkernel_that_is_given_an_array_says_that_it_makes_some(loaded: Loader) -> None:
    with pytest.raises(TypeError, match=r"inner makes arrays: declare it with makes=True"):
        loaded(inner="made(x)[0]", declared="subkernel").outer(1.0)
    assert loaded(inner="made(x)[0]", declared="subkernel(makes=True)").outer(1.0) == 1.0


@pytest.mark.parametrize(("declared", "called"), [("subkernel", True), ("subkernel(inline=True)", False)])
def test_a_large_subkernel_is_called_but_where_its_code_is_put_into_callers(
    loaded: Loader, declared: str, called: bool
) -> None:
    large = " + ".join(f"(x + {n}) / (x * x + {n})" for n in range(1, 60))
    several = loaded(inner=large, declared=declared).several
    several(1.0)
    (machine,) = several.inspect_asm().values()
    assert ("_ZN12edited_inner5inner" in machine) is called


def test_an_edit_of_a_constant_that_a_callee_reads_compiles_its_callers_anew(loaded: Loader) -> None:
    assert loaded().outer(1.0) == 2.0
    assert loaded(step=5.0).outer(1.0) == 6.0


def test_of_former_code_only_the_newest_is_kept(loaded: Loader, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(compiled, "FORMER", 1)
    found: list[Path] = []
    for factor in (2.0, 3.0, 4.0):
        outer = loaded(inner=f"x * {factor}").outer
        assert outer(1.0) == factor
        found += kept(outer)
    assert [each.exists() for each in found] == [False, True, True]


def test_what_is_called_with_numbers_as_written_is_compiled_once(loaded: Loader) -> None:
    assert loaded().several(3) == 9.0
    inner = vars(sys.modules["edited_inner"])["inner"]
    assert len(inner.signatures) == len(kept(inner)) == 1


def test_each_kind_of_argument_has_its_own_file(loaded: Loader) -> None:
    outer = loaded().outer
    assert (outer(1.0), outer(1)) == (2.0, 2.0)
    assert len(kept(outer)) == 2


def test_a_kernel_may_read_nothing_that_a_hash_cannot_tell(loaded: Loader) -> None:
    module = loaded(inner="x + TABLE[0]")
    vars(sys.modules["edited_inner"])["TABLE"] = [1.0]
    with pytest.raises(TypeError, match=r"edited_inner\.inner reads 'TABLE', a list"):
        made_of(module.outer.py_func)


def test_of_processes_that_ask_at_the_same_time_one_compiles(loaded: Loader) -> None:
    made_by = multiprocessing.get_context("fork")
    outer, told = loaded().outer, made_by.SimpleQueue()

    def ask() -> None:
        result = outer(1.0)
        told.put((sum(outer.stats.cache_hits.values()), sum(outer.stats.cache_misses.values()), result))

    asking = [made_by.Process(target=ask) for _ in range(2)]
    for each in asking:
        each.start()
    for each in asking:
        each.join()
    assert sorted(told.get() for _ in asking) == [(0, 1, 2.0), (1, 0, 2.0)]
    assert not list(kept(outer)[0].parent.glob("*.lock"))


@pytest.mark.parametrize(
    "damaged", [lambda was: was[:-99], lambda was: was[:-99] + b"0" * 99, lambda was: b""]
)
def test_what_is_not_there_as_it_was_written_is_compiled_anew(loaded: Loader, damaged) -> None:
    assert loaded().outer(1.0) == 2.0
    (file,) = kept(sys.modules["edited_outer"].outer)
    file.write_bytes(damaged(file.read_bytes()))
    for hits in (0, 1):
        again = loaded().outer
        assert again(1.0) == 2.0
        assert sum(again.stats.cache_hits.values()) == hits


def test_where_there_is_no_room_each_process_compiles_for_itself(loaded: Loader) -> None:
    outer, limits = loaded().outer, resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (0, limits[1]))
    try:
        assert outer(1.0) == 2.0
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, limits)
    assert kept(outer) == []


def test_who_could_not_compile_keeps_nobody_waiting(loaded: Loader) -> None:
    for _ in range(2):
        with pytest.raises(TypingError):
            loaded(inner="x.none").outer(1.0)
    assert loaded().outer(1.0) == 2.0


def test_what_compiling_and_loading_cost_is_no_work_of_the_thread(loaded: Loader) -> None:
    for _ in range(2):
        outer = loaded().outer
        spent, own = time.thread_time(), worked()
        assert outer(1.0) == 2.0
        spent, own = time.thread_time() - spent, worked() - own
        assert own < spent / 2


def test_garbage_that_compiling_leaves_is_not_looked_for_at_once(loaded: Loader) -> None:
    freed: list[int] = []

    def told(_phase: str, found: dict[str, int]) -> None:
        freed.append(found["collected"])

    gc.unfreeze()  # what other tests left so
    loaded().outer(1.0)  # what numba makes for its first compilation alone
    outer, frozen = loaded(inner="x + 2").outer, gc.get_freeze_count()
    gc.collect()
    gc.callbacks.append(told)
    try:
        assert outer(1.0) == 3.0
    finally:
        gc.callbacks.remove(told)
    assert (sum(freed), gc.get_freeze_count(), gc.isenabled()) == (0, frozen, True)
    assert gc.collect() > 0
