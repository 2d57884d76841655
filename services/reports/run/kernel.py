"""The interpreter that runs this process, as a Jupyter kernel of its own without network ports."""

import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

from jupyter_client.kernelspec import KernelSpec
from jupyter_client.manager import AsyncKernelManager

LANGUAGE = "python"


class OwnInterpreter(AsyncKernelManager):
    """This interpreter, whatever kernels are installed, over sockets in a folder of its own."""

    folder: Path

    @property
    def kernel_spec(self) -> KernelSpec:
        return KernelSpec(
            argv=[
                sys.executable,
                # ipykernel's launcher would take this folder out of the path, also where PYTHONPATH names it.
                "-P",
                "-Xfrozen_modules=off",
                "-m",
                "ipykernel",
                "-f",
                "{connection_file}",
                # Errors of cells come as messages; its log would tell only that it is asked to end.
                "--log-level=CRITICAL",
                # A `services.py` where the report is asked for is none of ours.
                "--ignore-cwd",
            ],
            display_name="sdt",
            language=LANGUAGE,
            # Nothing of the user's own set-up is read or written.
            env={"IPYTHONDIR": str(self.folder), "PYDEVD_DISABLE_FILE_VALIDATION": "1"},
        )


@contextmanager
def own_interpreter() -> Iterator[type[OwnInterpreter]]:
    """A class of kernel managers, as nbclient wants one; its folder is gone afterwards."""
    with TemporaryDirectory(prefix="sdt") as name:
        folder = Path(name)

        class Manager(OwnInterpreter):
            def __init__(self, **settings: Any) -> None:  # noqa: ANN401 - traitlets' own signature
                settings |= {"transport": "ipc", "connection_file": str(folder / "kernel.json")}
                super().__init__(**settings)
                self.folder = folder

        yield Manager
