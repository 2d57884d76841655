"""Which notebooks there are, what each asks, and which parameters it takes."""

import ast
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from pathlib import Path

import jupytext
from nbformat import NotebookNode

from sdt_kg.errors import InputError, UnknownEntityError
from sdt_kg.load import model_path

FOLDER = Path(__file__).parent.parent / "notebooks"
PARAMETERS = "parameters"
"""Tag of the cell that assigns them, as papermill wants it."""

Value = str | int | float | bool


@dataclass(frozen=True, slots=True)
class Parameter:
    """What can be chosen.

    Attributes:
        default: Its type is the parameter's.
        meaning: The comment behind it.
    """

    name: str
    default: Value
    meaning: str


@dataclass(frozen=True, slots=True)
class Notebook:
    """A notebook as it lies in the package.

    Attributes:
        name: Stem of its file.
        question: Its title.
        parameters: In their order.
        node: Cells without outputs.
    """

    name: str
    question: str
    parameters: tuple[Parameter, ...]
    node: NotebookNode

    def values(self, given: Iterable[str]) -> dict[str, Value]:
        """Values of `NAME=VALUE` texts, by name; what is not given is not there.

        Raises:
            UnknownEntityError: The notebook has no such parameter, or nothing is the kitchen or robot that
                a value names.
            InputError: No NAME=VALUE, a name twice, or a value of another type.
        """
        known, found = {each.name: each for each in self.parameters}, dict[str, Value]()
        for text in given:
            name, equals, value = text.partition("=")
            if not equals:
                raise InputError(f"'{text}' is no parameter", allowed="NAME=VALUE", remedy=self._remedy())
            if name not in known:
                raise UnknownEntityError(f"parameter of the report {self.name}", name, known, self._remedy())
            if name in found:
                raise InputError(f"the parameter {name} is given twice", allowed="each once")
            found[name] = _typed(known[name], value)
        _check_models(found)
        return found

    def _remedy(self) -> str:
        return "sdt report --list names all: here " + ", ".join(each.name for each in self.parameters)


def notebooks() -> tuple[Notebook, ...]:
    """All of the package, by name."""
    return tuple(map(_read, sorted(FOLDER.glob("*.py"))))


def notebook(name: str) -> Notebook:
    """The notebook of that name.

    Raises:
        UnknownEntityError: There is none.
    """
    found = {path.stem: path for path in FOLDER.glob("*.py")}
    if name not in found:
        raise UnknownEntityError("report", name, found, "sdt report --list says what each takes")
    return _read(found[name])


def _read(path: Path) -> Notebook:
    node = jupytext.reads(path.read_text(), fmt="py:percent")
    title = next(cell.source for cell in node.cells if cell.cell_type == "markdown")
    (chosen,) = (cell.source for cell in node.cells if PARAMETERS in cell.metadata.get("tags", []))
    return Notebook(path.stem, title.partition("\n")[0].lstrip("# "), tuple(_parameters(chosen)), node)


def _parameters(source: str) -> Iterable[Parameter]:
    """The assignments of a cell, with the comment behind each."""
    lines = source.splitlines()
    for node in ast.parse(source).body:
        assert isinstance(node, ast.Assign), "a cell of parameters has assignments only"
        (target,) = node.targets
        assert isinstance(target, ast.Name), "one name each"
        meaning = lines[node.lineno - 1].partition("  # ")[2]
        yield Parameter(target.id, ast.literal_eval(node.value), meaning)


def _check_models(values: Mapping[str, Value]) -> None:
    """Kitchen and robots are there: a kernel takes seconds to find out."""
    for name, kind in (("kitchen", "kitchen"), ("robot", "robot"), ("robots", "robot")):
        for each in str(values.get(name, "")).split(","):
            if each.strip():
                model_path(kind, each.strip())


def _typed(parameter: Parameter, text: str) -> Value:
    """The text as a value of the parameter's type."""
    kind = type(parameter.default)
    wrong = InputError(
        f"{parameter.name}='{text}' is no value", allowed=f"{_KINDS[kind]}; {parameter.meaning}"
    )
    if kind is bool:
        if text.lower() not in {"true", "false"}:
            raise wrong
        return text.lower() == "true"
    try:
        return kind(text)
    except ValueError:
        raise wrong from None


_KINDS = {str: "text", int: "a whole number", float: "a number", bool: "true or false"}
