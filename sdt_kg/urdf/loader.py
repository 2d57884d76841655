"""yourdfpy without trimesh, half of the time of a short command: it is for meshes and scenes alone."""

import sys
from functools import cache
from importlib import import_module
from importlib.util import find_spec
from types import ModuleType
from typing import Any, Final

TRIMESH: Final = "trimesh"
NAMED: Final = ("Trimesh", "Scene")
"""Its names that yourdfpy's annotations need while it is imported."""


class _Later(ModuleType):
    """A package whose modules can be imported; its own names are those of the package when asked for."""

    def __getattr__(self, name: str) -> Any:  # noqa: ANN401 - trimesh has no types of its own
        if sys.modules.get(self.__name__) is self:
            raise AttributeError(name)
        return getattr(import_module(self.__name__), name)


@cache
def yourdfpy() -> Any:  # noqa: ANN401 - it has no types of its own
    """The package; who imports trimesh later gets the real one, whole."""
    spec = None if TRIMESH in sys.modules else find_spec(TRIMESH)
    if spec is None or spec.submodule_search_locations is None:
        return import_module("yourdfpy")
    later = sys.modules[TRIMESH] = _Later(TRIMESH)
    later.__path__ = spec.submodule_search_locations
    for name in NAMED:
        setattr(later, name, object)
    try:
        return import_module("yourdfpy")
    finally:
        for name in NAMED:
            delattr(later, name)
        for name in [name for name in sys.modules if name.partition(".")[0] == TRIMESH]:
            del sys.modules[name]
