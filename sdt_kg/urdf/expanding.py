"""The process that expands one xacro file: run as a script, it knows nothing of the rest.

A xacro holds expressions that Python evaluates, and macros that may grow without end. So it is expanded
apart, with bounded time and memory, by a process that opens files of one folder only, starts nothing and
has no network. What comes out is one line of JSON, and the document if that says nothing is wrong.
"""

import ast
import importlib
import json
import os
import resource
import sys
from functools import partial
from pathlib import Path
from typing import Any
from xml.etree import ElementTree as ET

FORBIDDEN = ("subprocess.", "os.", "socket.", "ctypes.", "shutil.", "pty.", "import", "signal.", "mmap.")
"""Audit events of what an expression has no business to do; looking whether a file is there raises none."""

HARMLESS = ("os.listdir", "os.scandir")
"""What a pattern in the name of an included file needs."""


LEADING_OUT = ("vars", "type", "format", "format_map")
"""Names of xacro's, and methods of texts, that reach what begins with an underscore."""

TOO_LARGE = "it needs too much memory"


# xacro has no types of its own.
Loaded = Any


class RefusedError(Exception):
    """What the file asks for is not given."""


def main(source: str, folder: str, seconds: str, memory: str, largest: str) -> None:
    """One line of JSON, then the document."""
    resource.setrlimit(resource.RLIMIT_CPU, (int(seconds), int(seconds)))
    resource.setrlimit(resource.RLIMIT_AS, (int(memory), int(memory)))
    out = os.fdopen(os.dup(1), "wb")
    os.dup2(2, 1)  # what the file prints is not the document
    document, wrong = _expanded(source, Path(folder))
    if len(document) > int(largest):
        wrong = f"it grows to {len(document)} bytes; allowed: {largest}"
    out.write(json.dumps({"wrong": wrong}).encode() + b"\n" + (b"" if wrong else document))
    out.flush()
    os._exit(0)  # nothing is left to be done, and what the document left behind is large


def _expanded(source: str, folder: Path) -> tuple[bytes, str]:
    """The document, and what is wrong; one of them is empty."""
    guard = Guard(folder)
    xacro = guard.loaded()
    sys.addaudithook(guard.watch)
    try:
        return str(xacro.process_file(source).toxml()).encode(), ""
    except RecursionError:
        return b"", "a macro calls itself without end"
    except MemoryError:
        return b"", TOO_LARGE
    except Exception as error:  # noqa: BLE001 - whatever an expression raises is said to who asked
        short = isinstance(getattr(error, "exc", None), MemoryError)
        said = " ".join(str(error).split()) or type(error).__name__
        return b"", TOO_LARGE if short else guard.refused or said


class Guard:
    """What a file in a folder may do.

    Attributes:
        refused: The first file beyond the folder that it wanted to read, in words.
    """

    def __init__(self, folder: Path) -> None:
        self.folder, self.refused = folder, ""

    def loaded(self) -> Loaded:
        """Xacro, whose expressions are looked at first and which finds the folder's package."""
        importlib.import_module("xml.dom.expatbuilder")  # what is loaded later is refused
        xacro, arguments = map(importlib.import_module, ("xacro", "xacro.substitution_args"))
        parts: tuple[Loaded, Loaded] = xacro, arguments
        parts[0].safe_eval = partial(self.evaluated, parts[0].safe_eval)
        parts[1]._eval_find = parts[1]._eval_dict["find"] = self.find
        return parts[0]

    @staticmethod
    def evaluated(evaluate: Loaded, expression: str, *tables: Loaded) -> Loaded:
        """What an expression comes to.

        Raises:
            RefusedError: It names what leads out of xacro's own names.
        """
        for node in ast.walk(ast.parse(expression.strip(), mode="eval")):
            name = getattr(node, "id", None) or getattr(node, "attr", None) or ""
            if name.startswith("_") or name in LEADING_OUT:
                raise RefusedError(f"invalid name: {name}")
        return evaluate(expression, *tables)

    def find(self, package: str) -> str:
        """The folder, if it is that package's.

        Raises:
            RefusedError: It is another's.
        """
        described = self.folder / "package.xml"
        told = ET.parse(described).getroot().findtext("name") if described.is_file() else None  # noqa: S314
        if package not in {self.folder.name, (told or "").strip()}:
            raise RefusedError(f"package '{package}' is not the one that the file is in")
        return str(self.folder)

    def watch(self, event: str, details: tuple[Any, ...]) -> None:
        """An audit hook: files of the folder are read, and nothing else is done.

        Raises:
            RefusedError: Something else would be.
        """
        if event == "open" and not isinstance(details[0], int):
            path = Path(os.fsdecode(details[0]))
            if not path.resolve().is_relative_to(self.folder) or details[1] not in {"r", "rb"}:
                said = f"reads '{path}', which lies outside of '{self.folder}'"
                self.refused = self.refused or said
                raise RefusedError(said)
        elif event.startswith(FORBIDDEN) and event not in HARMLESS:
            raise RefusedError(f"it asks for {event}")


if __name__ == "__main__":
    main(*sys.argv[1:])
