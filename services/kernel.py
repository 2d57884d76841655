"""Compiled loops: declared here alone, and kept between processes by all that they are made of.

Most kernels are called by kernels alone. Of those (`subkernel`) no machine code is made and nothing is kept:
their callers hold it.
"""

import threading
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from functools import cache
from pathlib import Path
from typing import Any

import numba
from llvmlite.binding import parse_assembly
from numba.core import config, typed_passes, types, untyped_passes
from numba.core.codegen import JITCodeLibrary
from numba.core.compiler import CompilerBase
from numba.core.compiler_lock import global_compiler_lock
from numba.core.compiler_machinery import PassManager

from services.compiled import LEVEL, Kept, made_of
from services.garbage import unsought

_settings: Any = config
_njit: Any = numba.njit


class _Spent(threading.local):
    """Of each thread: how many kernels it waits for, one for the other, and what that has cost [s]."""

    depth, seconds = 0, 0.0


_spent = _Spent()


def worked() -> float:
    """Seconds of CPU of this thread, without those in which kernels were compiled or loaded."""
    return time.thread_time() - _spent.seconds


def kernel(
    function: Callable[..., Any] | None = None,
    *,
    makes: bool = True,
    shared: bool = False,
    **options: Any,  # noqa: ANN401 - of numba
) -> Any:  # noqa: ANN401 - of numba
    """A function that is compiled when it is first called with such arguments, once for all processes.

    Args:
        function: Reads numbers, other kernels, `math` and `numpy`, and no other names of its module.
        makes: Whether it makes arrays, or is given some by what it calls. Only then does it count who holds
            an array, at every view and every call: that takes a quarter of the time of such loops.
        shared: Whether kernels that call it run the machine code that there is of it, and hold none of their
            own: for what is large and called by many.
        options: Of `numba.njit`.
    """
    if function is None:
        return lambda each: kernel(each, makes=makes, shared=shared, **options)
    pipeline = _Shared if shared else _Pipeline
    made = _njit(pipeline_class=pipeline, no_cfunc_wrapper=True, _nrt=makes, **options)(function)
    made._cache = Kept(function, shared)  # as `cache=True` does
    # Extensions of numba are looked for when it compiles; what was kept needs none.
    made._compilation_chain_init_hook = lambda: None
    made.compile = _once(made._cache, made.targetctx, made.compile)
    return _for_all_numbers(made)


def _once(cache: Kept, context: Any, usual: Callable[[Any], Any]) -> Callable[[Any], Any]:  # noqa: ANN401 - of numba
    """Compiled by one process, for all that ask at the same time; what it takes is no work of its thread."""

    def compiled(signature: Any) -> Any:  # noqa: ANN401 - of numba
        began, _spent.depth = time.thread_time(), _spent.depth + 1
        try:
            # In this order: a thread that waits for a file must not be waited for by the one that has it.
            with global_compiler_lock, cache.alone(signature, context):
                return usual(signature)
        finally:
            _spent.depth -= 1
            if not _spent.depth:
                _spent.seconds += time.thread_time() - began

    return compiled


def subkernel(
    function: Callable[..., Any] | None = None, *, makes: bool = False, inline: bool = False
) -> Any:  # noqa: ANN401 - of numba
    """A kernel that only kernels call: compiled into each of them. Called from Python, it is a `kernel`.

    Args:
        function: As above.
        makes: As above, but for what is usual.
        inline: Whether its code is put wherever it is called: for what is called often and given many
            arrays. Each of them is seven arguments, and handing them on can take longer than the rest.
    """
    if function is None:
        return lambda each: subkernel(each, makes=makes, inline=inline)
    options = {"no_cfunc_wrapper": True, "no_cpython_wrapper": True, "_nrt": makes, "forceinline": inline}
    made = _njit(pipeline_class=_Inner, **options)(function)
    whole = cache(lambda: kernel(function))
    made.add_overload = lambda part: made.overloads.update({tuple(part.signature.args): part})
    made._compile_for_args = lambda *_, **__: whole()  # asked where no overload can be called from Python
    return _for_all_numbers(made)


def _for_all_numbers(made: Any) -> Any:  # noqa: ANN401 - of numba
    """Compiled once: numba would compile it for each number that a caller writes, as a type of its own."""
    template = made.get_call_template
    made.get_call_template = lambda args, named: template(
        tuple(map(types.unliteral, args)), {name: types.unliteral(each) for name, each in named.items()}
    )
    return made


def is_kernel(value: object) -> bool:
    """Whether it was declared here."""
    return isinstance(getattr(value, "_cache", None), Kept)


def kept(compiled: Any) -> list[Path]:  # noqa: ANN401 - numba's dispatcher
    """Files that hold what was compiled of a kernel as it is now, one for the types of each call."""
    return compiled._cache.files()


PASSES = (
    untyped_passes.TranslateByteCode,
    untyped_passes.FixupArgs,
    untyped_passes.IRProcessing,
    untyped_passes.RewriteSemanticConstants,
    untyped_passes.GenericRewrites,
    untyped_passes.ReconstructSSA,
    typed_passes.NopythonTypeInference,
    typed_passes.PreLowerStripPhis,
    typed_passes.IRLegalization,
    typed_passes.AnnotateTypes,
    typed_passes.NativeLowering,
    typed_passes.NoPythonBackend,
)
"""numba's, as loops over numbers need them: it has a dozen more, for closures, `with`, sums of arrays."""


class _Compiler(CompilerBase):
    """numba's own, with fewer passes."""

    def define_pipelines(self) -> list[PassManager]:
        manager: Any = PassManager("kernel")
        for each in PASSES:
            manager.add_pass(each, each.__name__)
        manager.finalize()
        return [manager]


class _Whole(JITCodeLibrary):
    """Code that is made fast once, with all that it calls: numba would begin before it has that."""

    def _optimize_functions(self, ll_module: Any) -> None:  # noqa: ANN401 - llvmlite's
        ll_module.data_layout = self._codegen._data_layout


class _Apart(_Whole):
    """Code of which callers take nothing in but its name."""

    def _get_module_for_linking(self) -> object:
        return parse_assembly("")

    def serialize_using_object_code(self) -> object:
        """All of it, for those who load it."""
        content = self._get_compiled_object(), super()._get_module_for_linking().as_bitcode()
        return self.name, "object", content


class _Part(JITCodeLibrary):
    """Code that waits for its callers, and is made fast together with them."""

    def _optimize_final_module(self) -> None:
        """Not before its callers are: each of its functions was made small."""

    def _finalize_final_module(self) -> None:
        """It stays as it is."""
        self._finalize_dynamic_globals()
        self._verify_declare_only_symbols()
        self._finalized = True


class _Pipeline(_Compiler):
    """At our level of optimisation; numba lets one thread compile at a time."""

    library: type[JITCodeLibrary] = _Whole

    def compile_extra(self, func: Any) -> object:  # noqa: ANN401 - numba's
        context: Any = self.state.targetctx  # a copy, of this compilation alone
        self.state.library = self.library(context.codegen(), func.__qualname__)
        self.state.library.enable_object_caching()
        with _at_level():
            made: Any = super().compile_extra(func)
        _refuse_arrays(self.state)
        for environment in made._find_referenced_environments():
            made.codegen.set_env(environment.env_name, environment)  # of what is inside too
        return made


class _Shared(_Pipeline):
    """The same under a name that follows from all that it is made of: so callers of any process find it."""

    library = _Apart

    def compile_extra(self, func: Any) -> object:  # noqa: ANN401 - numba's
        context: Any = self.state.targetctx  # a copy, of this compilation alone
        usual, stamp = context.mangler, made_of(func)
        context.mangler = lambda name, *args, uid, **named: usual(f"{name}_{stamp}", *args, **named)
        return super().compile_extra(func)


class _Inner(_Compiler):
    """The same for what only kernels call: no machine code, which would be a third of the time."""

    def compile_extra(self, func: Any) -> object:  # noqa: ANN401 - numba's
        context: Any = self.state.targetctx  # a copy, of this compilation alone
        context.get_executable = lambda *_: object()  # by which numba finds it, and nothing calls it
        self.state.library = _Part(context.codegen(), func.__qualname__)
        with _at_level():
            made = super().compile_extra(func)
        _refuse_arrays(self.state)
        return made


def _refuse_arrays(state: Any) -> None:  # noqa: ANN401 - of numba
    """Who does not count who holds an array gives none away, and is given none to throw away."""
    called = (each for node, each in state.calltypes.items() if getattr(node, "op", "") == "call")
    given = (state.return_type, *(each.return_type for each in called))
    if not state.flags.nrt and any(map(_is_array, given)):
        raise TypeError(f"the kernel {state.func_id.func_qualname} makes arrays: declare it with makes=True")


def _is_array(kind: Any) -> bool:  # noqa: ANN401 - of numba
    """Whether values of a type are arrays, or hold some."""
    return any(map(_is_array, getattr(kind, "types", ()))) or isinstance(kind, types.Array)


@contextmanager
def _at_level() -> Iterator[None]:
    """LLVM optimises at our level; looking for garbage, a fifth of the time, waits.

    To free what compiling leaves takes a tenth more: it goes to what is old, which is looked at last.
    """
    usual = _settings.OPT
    _settings.OPT = type(usual)(min(usual, LEVEL))
    try:
        with unsought():
            yield
    finally:
        _settings.OPT = usual
