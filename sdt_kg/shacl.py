"""pySHACL without the grammar of SPARQL, half of what importing it takes: no shape of ours asks for it."""

import sys
import threading
from functools import cache
from importlib import import_module
from importlib.util import find_spec
from types import ModuleType
from typing import Any, Final

SPARQL: Final = "rdflib.plugins.sparql"
"""A package that imports all of its modules; pySHACL begins with two, which need no others."""


@cache
def pyshacl() -> Any:  # noqa: ANN401 - its annotations are partial
    """The package; a shape with SPARQL, and who imports rdflib's later, gets that whole.

    Beside other threads all is imported as usual: one of them might ask for it meanwhile.
    """
    spec = find_spec(SPARQL)
    alone = SPARQL not in sys.modules and threading.active_count() == 1
    if not alone or spec is None or spec.submodule_search_locations is None:
        return import_module("pyshacl")
    bare = sys.modules[SPARQL] = ModuleType(SPARQL)
    bare.__path__ = spec.submodule_search_locations
    try:
        return import_module("pyshacl")
    finally:
        del sys.modules[SPARQL]
