"""Machine code of kernels, kept between processes by all that it is made of.

numba keeps what it compiled by the file of a function, but compiles into it what the function calls: after an
edit of a callee in another file the old code would stay in use. Here the name of what is kept follows from
the code of the function, of everything that it calls and of each constant that they read, not from dates
of files: an edit of any of these compiles anew what holds it, a fresh checkout of the same sources nothing.
"""

import fcntl
import hashlib
import io
import math
import pickle
import sys
import time
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager, suppress
from functools import cache, cached_property
from pathlib import Path
from types import CodeType, FunctionType, ModuleType
from typing import Any

import numba
import numpy as np
from llvmlite import binding
from numba.core.caching import CompileResultCacheImpl, _Cache
from numba.core.dispatcher import Dispatcher
from numba.core.environment import Environment, _rebuild_env, lookup_environment
from numba.core.runtime.nrt import rtsys
from numba.core.serialize import dumps

from services.keeping import files

FORMER = 4
"""[1] Files of former code that are kept of a function: one goes to and fro between branches."""

LIBRARIES = {"math", "numpy"}
"""Modules of which a kernel may read attributes; what they mean is numba's, and told by its version."""

LEVEL = 2
"""[1] LLVM's level of optimisation. At numba's 3 compiling takes a third longer, and loops run no faster."""

FORM = 4
"""[1] Raised when what is written of compiled code changes its form."""

DIGITS = 24
"""[1] Of a hash, in the name of a file."""


def made_of(function: FunctionType) -> str:
    """Hash of a function, of all that it calls and of the constants which both read.

    Raises:
        TypeError: It reads what no hash can stand for: an array, a list, a name of another module.
    """
    parts: dict[str, str] = {}
    _collect(function, "", parts)
    said = repr((numba.__version__, np.__version__, LEVEL, FORM, sorted(parts.items())))
    return hashlib.sha256(said.encode()).hexdigest()[:DIGITS]


def _name(function: FunctionType) -> str:
    return f"{function.__module__}.{function.__qualname__}"


def _collect(function: FunctionType, options: str, parts: dict[str, str]) -> None:
    name = _name(function)
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
                callee: Any = value
                shared = getattr(callee._cache, "shared", False)
                _collect(value.py_func, repr((shared, sorted(value.targetoptions.items()))), parts)
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


def _called(function: FunctionType, found: dict[str, Any]) -> dict[str, Any]:
    """Name → each kernel that it calls, or that one of these calls."""
    for read in _names(function.__code__):
        value = function.__globals__.get(read)
        if isinstance(value, Dispatcher) and (name := _name(value.py_func)) not in found:
            found[name] = value
            _called(value.py_func, found)
    return found


def _age(file: Path) -> float:
    """[s] Before now; of one that another process removed, endless."""
    try:
        return time.time() - file.stat().st_mtime
    except FileNotFoundError:
        return math.inf


def _parts(reduced: Any, shared: bool) -> tuple[object, ...]:  # noqa: ANN401 - of numba
    """What is written: numba's tuple without the bitcode, names that this defines, and what callers take in.

    To read the bitcode takes longer than all the rest, and only who compiles a caller needs it.
    """
    (name, kind, (machine, bitcode)), *rest = reduced
    module = binding.parse_bitcode(bitcode)
    values = (*module.functions, *module.global_variables)
    names = frozenset(each.name for each in values if not each.is_declaration)
    nothing = binding.parse_assembly("").as_bitcode()
    return ((name, kind, (machine, nothing)), *rest), names, nothing if shared else bitcode


class _Reader(pickle.Unpickler):  # as numba reads its own
    """What was written; numba's modules are not imported for names that only object mode asks for."""

    def find_class(self, module: str, name: str) -> Any:  # noqa: ANN401 - whatever was written
        rebuild = _rebuild_env.__module__, _rebuild_env.__name__
        return _environment if (module, name) == rebuild else super().find_class(module, name)


def _environment(module: str, constants: list[object], name: str) -> object:
    """As numba makes it of what was written of it."""
    if module in sys.modules or not module.startswith("numba."):
        return _rebuild_env(module, constants, name)
    known = lookup_environment(name)
    if known is None:
        Environment._memo[name] = known = Environment({"__name__": module})
        known.consts[:], known.env_name = constants, name
    return known


class Kept(_Cache):
    """Whom numba asks for compiled code: a file for the types of each call, whose name tells what is in it.

    Nothing is looked for before the first call: what a kernel calls may stand below it in its module.
    """

    def __init__(self, function: FunctionType, shared: bool = False) -> None:
        self._function, self.shared, self._enabled = function, shared, True

    @property
    def cache_path(self) -> str:
        """`NUMBA_CACHE_DIR`, beside the source, or the user's own folder: where numba would keep it."""
        return self._placed.locator.get_cache_path()

    @contextmanager
    def alone(self, sig: object, target_context: Any) -> Iterator[None]:  # noqa: ANN401 - numba's
        """Nobody else compiles the same for these types: who comes later waits, and finds what was kept."""
        path = self._path(self._key(sig, target_context.codegen())).with_suffix(".lock")
        if not self._enabled or path.with_suffix(".nbc").exists():
            yield
            return
        with ExitStack() as held:
            with suppress(OSError):  # where files cannot be made or locked: each then compiles for itself
                self._placed.locator.ensure_cache_path()
                file = held.enter_context(path.open("w"))
                held.callback(path.unlink, missing_ok=True)
                fcntl.flock(file, fcntl.LOCK_EX)
            yield

    def load_overload(self, sig: object, target_context: Any) -> object:  # noqa: ANN401 - numba's
        """What was compiled for these types, byte for byte as it was kept, or None."""
        # Loading needs numba's memory alone; all that numba can compile it looks up before it compiles.
        rtsys.initialize(target_context)
        key = self._key(sig, target_context.codegen())
        content = files.read(self._path(key)) if self._enabled else None
        same, needed, *parts = _Reader(io.BytesIO(content)).load() if content else (None, ())
        if same != key:
            return None
        callees = _called(self._function, {}) if needed else {}
        for name, types in needed:  # before code is loaded that calls them
            callees[name].compile(types)
        return self._rebuilt(target_context, *parts)

    def save_overload(self, sig: object, data: Any) -> None:  # noqa: ANN401 - numba's
        """It is kept, and of the function as it was before only what is newest."""
        if not self._enabled or not self._placed.check_cachable(data):
            return
        for each in sorted(self._former(), key=_age)[FORMER:]:
            with suppress(OSError):
                each.unlink()
        key = self._key(sig, data.codegen)
        parts = _parts(self._placed.reduce(data), self.shared)
        files.write(self._path(key), dumps((key, self._needed(data), *parts)))

    def _needed(self, data: Any) -> list[tuple[str, object]]:  # noqa: ANN401 - numba's
        """Names and types of kernels that such code calls and does not hold."""
        absent = {each.name for each in data.library._final_module.functions if each.is_declaration}
        callees = _called(self._function, {}).items()
        made = ((name, each) for name, callee in callees for each in callee.overloads.values())
        return [(name, each.signature.args) for name, each in made if each.fndesc.mangled_name in absent]

    def _rebuilt(self, context: Any, reduced: object, names: frozenset[str], bitcode: bytes) -> object:  # noqa: ANN401 - numba's
        """What numba makes of such parts; a caller that is compiled takes the bitcode."""
        context.codegen()._engine._defined_symbols |= names
        made = self._placed.rebuild(context, reduced)
        made.library._get_module_for_linking = cache(lambda: binding.parse_bitcode(bitcode))
        return made

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
