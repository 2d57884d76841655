"""A notebook run from top to bottom: parameters in, outputs out, typed errors as on the shell."""

import logging
import sys
import warnings
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from copy import deepcopy
from typing import Final

import papermill
from nbclient.exceptions import DeadKernelError
from nbformat import NotebookNode
from papermill.exceptions import PapermillExecutionError

from sdt_kg import errors
from sdt_kg.errors import InputError, SdtError
from services.reports.run.catalogue import Notebook, Value
from services.reports.run.kernel import own_interpreter

TYPED: Final = {
    name: kind for name, kind in vars(errors).items() if isinstance(kind, type) and issubclass(kind, SdtError)
}
"""Errors that the shell knows how to tell, by name."""


class BrokenReportError(RuntimeError):
    """A notebook failed, and not because of what it was given; the message has its traceback."""


class GivenError(InputError):
    """What a notebook was given is wrong; the message is the one of the error that it ended with."""

    def __init__(self, message: str) -> None:
        super().__init__(message)


def executed(notebook: Notebook, values: Mapping[str, Value]) -> NotebookNode:
    """The notebook with its outputs; a bar on a terminal shows how far it is.

    Args:
        notebook: As the catalogue gives it.
        values: Parameters that differ from their defaults.

    Raises:
        GivenError: The notebook ended with an `InputError`.
        SdtError: It ended with another error of this project.
        BrokenReportError: It ended with anything else.
    """
    with own_interpreter() as manager, warnings.catch_warnings(), _quiet():
        # papermill closes what it opened when its own collector runs; no concern of a report.
        warnings.simplefilter("ignore", ResourceWarning)
        try:
            return papermill.execute_notebook(
                deepcopy(notebook.node),
                None,
                dict(values),
                kernel_name="python3",
                language="python",
                progress_bar=sys.stderr.isatty(),
                kernel_manager_class=manager,
            )
        except PapermillExecutionError as error:
            raise told_as(notebook, error) from None
        except DeadKernelError:
            what = f"the process of the report {notebook.name} was ended from outside"
            raise SdtError(f"{what}: too little memory, most often") from None


@contextmanager
def _quiet() -> Iterator[None]:
    """Papermill says nothing of parameters whose comments it cannot read: the catalogue reads them itself."""
    log = logging.getLogger("papermill")
    before = log.level
    log.setLevel(logging.ERROR)
    try:
        yield
    finally:
        log.setLevel(before)


def told_as(notebook: Notebook, error: PapermillExecutionError) -> Exception:
    """The error with which a cell ended, as this process would have raised it."""
    kind = TYPED.get(error.ename)
    if kind is None:
        return BrokenReportError(f"cell {error.cell_index + 1} of the report {notebook.name}{error}")
    return GivenError(error.evalue) if issubclass(kind, InputError) else SdtError(error.evalue)
