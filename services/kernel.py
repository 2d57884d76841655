"""Compiled loops: declared here alone, and kept between processes by all that they are made of.

numba keeps what it compiled by the file of a function, but compiles into it what the function calls: after an
edit of a callee in another file the old code would stay in use. Here the name of what is kept follows from
the code of the function, of everything that it calls and of each constant that they read, not from dates
of files: an edit of any of these compiles anew what holds it, a fresh checkout of the same sources nothing.

Most kernels are called by kernels alone. Of those (`subkernel`) no machine code is made and nothing is kept:
their callers hold it.
"""

import gc
import hashlib
import math
import pickle
import sys
import tempfile
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from functools import cache, cached_property
from pathlib import Path
from types import CodeType, FunctionType, ModuleType
from typing import Any

import numba
import numpy as np
from numba.core import config, types
from numba.core.caching import CompileResultCacheImpl, _Cache
from numba.core.codegen import JITCodeLibrary
from numba.core.compiler import Compiler
from numba.core.dispatcher import Dispatcher
from numba.core.runtime.nrt import rtsys
from numba.core.serialize import dumps

FORMER = 4
"""[1] Files of former code that are kept of a function: one goes to and fro between branches."""

LIBRARIES = {"math", "numpy"}
"""Modules of which a kernel may read attributes; what they mean is numba's, and told by its version."""

LEVEL = 2
"""[1] LLVM's level of optimisation. At numba's 3 compiling takes a third longer, and loops run no faster."""

DIGITS = 24
"""[1] Of a hash, in the name of a file."""

_settings: Any = config
_njit: Any = numba.njit


def kernel(function: Callable[..., Any] | None = None, **options: Any) -> Any:  # noqa: ANN401 - of numba
    """A function that is compiled when it is first called with such arguments, once for all processes.

    Args:
        function: Reads numbers, other kernels, `math` and `numpy`, and no other names of its module.
        options: Of `numba.njit`.
    """
    if function is None:
        return lambda each: kernel(each, **options)
    made = _njit(pipeline_class=_Pipeline, no_cfunc_wrapper=True, _nrt=True, **options)(function)
    made._cache = _Kept(function)  # as `cache=True` does
    return made


def subkernel(function: Callable[..., Any] | None = None, *, makes: bool = False) -> Any:  # noqa: ANN401 - of numba
    """A kernel that only kernels call: compiled into each of them. Called from Python, it is a `kernel`.

    Args:
        function: As above.
        makes: Whether it makes arrays, or is given some by what it calls. Only then does it count who holds
            an array, at every view and every call: that takes a quarter of the time of such loops.
    """
    if function is None:
        return lambda each: subkernel(each, makes=makes)
    options = {"no_cfunc_wrapper": True, "no_cpython_wrapper": True, "_nrt": makes}
    made = _njit(pipeline_class=_Inner, **options)(function)
    whole = cache(lambda: kernel(function))
    made.add_overload = lambda part: made.overloads.update({tuple(part.signature.args): part})
    made._compile_for_args = lambda *_, **__: whole()  # asked where no overload can be called from Python
    return made


def is_kernel(value: object) -> bool:
    """Whether it was declared here."""
    return isinstance(getattr(value, "_cache", None), _Kept)


def kept(compiled: Any) -> list[Path]:  # noqa: ANN401 - numba's dispatcher
    """Files that hold what was compiled of a kernel as it is now, one for the types of each call."""
    return compiled._cache.files()


def made_of(function: FunctionType) -> str:
    """Hash of a function, of all that it calls and of the constants which both read.

    Raises:
        TypeError: It reads what no hash can stand for: an array, a list, a name of another module.
    """
    parts: dict[str, str] = {}
    _collect(function, "", parts)
    said = repr((numba.__version__, np.__version__, LEVEL, sorted(parts.items())))
    return hashlib.sha256(said.encode()).hexdigest()[:DIGITS]


def _collect(function: FunctionType, options: str, parts: dict[str, str]) -> None:
    name = f"{function.__module__}.{function.__qualname__}"
    if name in parts:
        return
    if function.__closure__:
        raise TypeError(f"the kernel {name} reads names of the function around it; pass them as arguments")
    parts[name] = repr((options, function.__defaults__, _written(function.__code__, function.__doc__)))
    for read in sorted(_names(function.__code__)):
        if read not in function.__globals__:
            continue  # a builtin, or an attribute
        value = function.__globals__[read]
        match value:
            case Dispatcher():
                _collect(value.py_func, repr(sorted(value.targetoptions.items())), parts)
            case ModuleType() if value.__name__ in LIBRARIES:
                pass
            case bool() | int() | float() | str() | tuple() | None:
                parts[f"{name}: {read}"] = repr(value)
            case _:
                what = f"the kernel {name} reads '{read}', a {type(value).__name__}"
                raise TypeError(f"{what}: numbers, kernels, math and numpy are what a kernel may read")


def _written(code: CodeType, doc: str | None) -> tuple[object, ...]:
    """What a function does, without where it stands and what its docstring says."""
    said = tuple(
        _written(each, None) if isinstance(each, CodeType) else repr(each)
        for each in code.co_consts
        if doc is None or each != doc
    )
    return code.co_code, code.co_names, code.co_varnames, code.co_argcount, said


def _names(code: CodeType) -> set[str]:
    inner = (each for each in code.co_consts if isinstance(each, CodeType))
    return set(code.co_names).union(*map(_names, inner))


class _Pipeline(Compiler):
    """numba's own, at our level of optimisation; numba lets one thread compile at a time."""

    def compile_extra(self, func: object) -> object:
        with _at_level():
            made: Any = super().compile_extra(func)
        for environment in made._find_referenced_environments():
            made.codegen.set_env(environment.env_name, environment)  # of what is inside too
        return made


class _Inner(Compiler):
    """The same for what only kernels call: no machine code, which would be a third of the time."""

    def compile_extra(self, func: Any) -> object:  # noqa: ANN401 - numba's
        context: Any = self.state.targetctx  # a copy, of this compilation alone
        context.get_executable = lambda *_: object()  # by which numba finds it, and nothing calls it
        self.state.library = _Part(context.codegen(), func.__qualname__)
        with _at_level():
            made = super().compile_extra(func)
        if not self.state.flags.nrt:
            self._refuse_arrays(func.__qualname__)
        return made

    def _refuse_arrays(self, name: str) -> None:
        """Who does not count who holds an array gives none away, and is given none to throw away."""
        called = (each for node, each in self.state.calltypes.items() if getattr(node, "op", "") == "call")
        if any(map(_is_array, (self.state.return_type, *(each.return_type for each in called)))):
            raise TypeError(f"the subkernel {name} makes arrays: declare it @subkernel(makes=True)")


def _is_array(kind: Any) -> bool:  # noqa: ANN401 - of numba
    """Whether values of a type are arrays, or hold some."""
    return any(map(_is_array, getattr(kind, "types", ()))) or isinstance(kind, types.Array)


class _Part(JITCodeLibrary):
    """Code that waits for its callers, and is made fast together with them."""

    def _optimize_final_module(self) -> None:
        """Made small, so that they copy less."""
        codegen: Any = self._codegen
        vectorise = {"loop_vectorize": False, "slp_vectorize": False}
        manager, passes = codegen._module_pass_manager(opt=codegen._opt_level, cost="cheap", **vectorise)
        manager.run(self._final_module, passes)

    def _finalize_final_module(self) -> None:
        """It stays as it is."""
        self._finalize_dynamic_globals()
        self._verify_declare_only_symbols()
        self._finalized = True


@contextmanager
def _at_level() -> Iterator[None]:
    """LLVM optimises at our level; looking for garbage, a fifth of the time, waits."""
    usual, collects = _settings.OPT, gc.isenabled()
    _settings.OPT = type(usual)(min(usual, LEVEL))
    gc.disable()
    try:
        yield
    finally:
        _settings.OPT = usual
        if collects:
            gc.enable()


def _age(file: Path) -> float:
    """[s] Before now; of one that another process removed, endless."""
    try:
        return time.time() - file.stat().st_mtime
    except FileNotFoundError:
        return math.inf


class _Kept(_Cache):
    """Whom numba asks for compiled code: a file for the types of each call, whose name tells what is in it.

    Nothing is looked for before the first call: what a kernel calls may stand below it in its module.
    """

    def __init__(self, function: FunctionType) -> None:
        self._function, self._enabled = function, True

    @property
    def cache_path(self) -> str:
        """`NUMBA_CACHE_DIR`, beside the source, or the user's own folder: where numba would keep it."""
        return self._placed.locator.get_cache_path()

    def load_overload(self, sig: object, target_context: Any) -> object:  # noqa: ANN401 - numba's
        """What was compiled for these types, or None."""
        # Loading needs numba's memory alone; all that numba can compile it looks up before it compiles.
        rtsys.initialize(target_context)
        key = self._key(sig, target_context.codegen())
        try:
            content = self._path(key).read_bytes() if self._enabled else b""
        except FileNotFoundError:
            return None
        same, data = pickle.loads(content) if content else (None, None)  # noqa: S301 - as numba reads its own
        return self._placed.rebuild(target_context, data) if same == key else None

    def save_overload(self, sig: object, data: Any) -> None:  # noqa: ANN401 - numba's
        """It is kept, and of the function as it was before only what is newest."""
        if not self._enabled or not self._placed.check_cachable(data):
            return
        self._placed.locator.ensure_cache_path()
        for each in sorted(self._former(), key=_age)[FORMER:]:
            each.unlink(missing_ok=True)
        key = self._key(sig, data.codegen)
        with tempfile.NamedTemporaryFile(dir=self._folder, suffix=".tmp", delete=False) as file:
            file.write(dumps((key, self._placed.reduce(data))))
        Path(file.name).replace(self._path(key))

    def files(self) -> list[Path]:
        """Those of the function as it is now."""
        return sorted(self._folder.glob(f"{self._stem}.{self._stamp}.*.nbc"))

    def _former(self) -> set[Path]:
        return set(self._folder.glob(f"{self._stem}.*.nbc")).difference(self.files())

    def enable(self) -> None:
        self._enabled = True

    def disable(self) -> None:
        self._enabled = False

    def flush(self) -> None:
        """Nothing is kept any more."""
        for each in self._folder.glob(f"{self._stem}.*.nbc"):
            each.unlink(missing_ok=True)

    @cached_property
    def _placed(self) -> CompileResultCacheImpl:
        return CompileResultCacheImpl(self._function)

    @cached_property
    def _stamp(self) -> str:
        return made_of(self._function)

    @property
    def _folder(self) -> Path:
        return Path(self.cache_path)

    @property
    def _stem(self) -> str:
        module = Path(self._function.__code__.co_filename).stem
        return f"{module}.{self._function.__qualname__}.{sys.implementation.cache_tag}"

    def _key(self, sig: object, codegen: Any) -> tuple[object, object]:  # noqa: ANN401 - numba's
        """Types and machine."""
        return sig, codegen.magic_tuple()

    def _path(self, key: object) -> Path:
        types = hashlib.sha256(repr(key).encode()).hexdigest()[:DIGITS]
        return self._folder / f"{self._stem}.{self._stamp}.{types}.nbc"
