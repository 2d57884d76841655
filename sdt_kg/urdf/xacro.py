"""xacro → XML, expanded in a process of its own whose time, memory and files are bounded."""

import json
import os
import subprocess
import sys
from pathlib import Path
from typing import Final

from sdt_kg.errors import UrdfError
from sdt_kg.urdf.document import MAX_BYTES, refuse_unsafe
from sdt_kg.urdf.folder import WIDER, folder_of

SECONDS: Final = 10
"""[s] Of CPU. The largest xacro that we know of, with three robots in it, takes one."""

MEMORY: Final = 2_000_000_000
"""[byte]"""

PATIENCE: Final = 60
"""[s] Until a process that waits for something is given up."""

BY_HAND: Final = "run xacro on it by hand, with its arguments: xacro FILE NAME:=VALUE > FILE.urdf"

SCRIPT: Final = Path(__file__).with_name("expanding.py")


def expanded(path: Path) -> bytes:
    """The document that a xacro file stands for.

    Raises:
        UrdfError: It says nothing that can be expanded, takes too much to be, or reads what is not its own.
    """
    refuse_unsafe(path.read_bytes(), path)
    folder = folder_of(path)
    words = (str(path), str(folder), str(SECONDS), str(MEMORY), str(MAX_BYTES))
    # No variable of who asks is for the file to read, and our own search path is not for it to change.
    environment = {"PYTHONPATH": os.pathsep.join(filter(None, sys.path)), "PYTHONUTF8": "1"}
    try:
        done = subprocess.run(  # noqa: S603 - our own script, without a shell
            [sys.executable, "-P", "-S", str(SCRIPT), *words],
            env=environment,
            stdin=subprocess.DEVNULL,
            stdout=subprocess.PIPE,
            timeout=PATIENCE,
            check=False,
        )
    except subprocess.TimeoutExpired:
        raise _too_much(path) from None
    head, _, document = done.stdout.partition(b"\n")
    if done.returncode or not head:
        raise _too_much(path)
    wrong = str(json.loads(head)["wrong"])
    if wrong.startswith("reads '"):
        raise UrdfError(
            f"{path}: {wrong}",
            allowed="files below that folder, which is the one with package.xml if there is one",
            remedy=f"put it there, {WIDER}, or {BY_HAND}",
        )
    if wrong:
        raise UrdfError(f"{path}: xacro says: {wrong}", remedy=BY_HAND)
    return document


def _too_much(path: Path) -> UrdfError:
    return UrdfError(
        f"{path}: expanding it takes too much",
        allowed=f"{SECONDS} s of CPU and {MEMORY / 1e9:g} GB of memory",
        remedy="look for an expression or a macro that grows without end",
    )
