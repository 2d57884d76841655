"""An executed notebook as files: one HTML page that loads nothing, and what papers take."""

import binascii
from collections.abc import Iterator, Mapping
from datetime import UTC, datetime
from importlib.metadata import version
from pathlib import Path

import nbformat
from nbconvert import HTMLExporter
from nbformat import NotebookNode
from pygments.formatters import HtmlFormatter

from sdt_kg.errors import InputError
from services.reports.pages import figure, table
from services.reports.run.catalogue import Notebook, Value
from services.store.output import check_file, write_file

TEMPLATES = Path(__file__).parent.parent / "pages"
TEMPLATE = "paper"


def page(notebook: Notebook, node: NotebookNode, values: Mapping[str, Value]) -> str:
    """One HTML page with everything in it: the browser is told to load nothing else."""
    exporter = HTMLExporter(
        template_name=TEMPLATE, extra_template_basedirs=[str(TEMPLATES)], exclude_anchor_links=True
    )
    shown = {each.name: values.get(each.name, each.default) for each in notebook.parameters}
    style, now = (TEMPLATES / TEMPLATE / "style.css").read_text(), datetime.now(UTC)
    about = {
        "title": notebook.question,
        "style": style + HtmlFormatter().get_style_defs(".highlight"),
        "made": f"sdt report {notebook.name}, sdt-kg {version('sdt-kg')}, {now:%Y-%m-%d %H:%M} UTC",
        "parameters": {name: str(value) if str(value) else "(none)" for name, value in shown.items()},
    }
    text, _ = exporter.from_notebook_node(node, resources={"sdt": about})
    return text


def write(path: Path, notebook: Notebook, node: NotebookNode, values: Mapping[str, Value]) -> None:
    """The report as `.html`, or the executed notebook as `.ipynb`.

    Raises:
        InputError: Another suffix, or a folder that is not there.
    """
    checked(path)
    write_file(path, nbformat.writes(node) if path.suffix == ".ipynb" else page(notebook, node, values))


def checked(path: Path) -> Path:
    """The path, if a report can be written there: known before the work begins.

    Raises:
        InputError: Another suffix, or a folder that is not there.
    """
    if path.suffix not in {".html", ".ipynb"}:
        raise InputError(
            f"'{path}' is no report", allowed="FILE.html, or FILE.ipynb for the executed notebook"
        )
    if not path.parent.is_dir() or path.is_dir():
        raise InputError(f"'{path}' cannot be written", allowed="a file in a folder that is there")
    check_file(path)
    return path


def write_assets(folder: Path, node: NotebookNode) -> list[Path]:
    """Every figure as SVG and PDF, every table as CSV and LaTeX; the files written, in their order."""
    folder.mkdir(parents=True, exist_ok=True)
    written = list[Path]()
    for name, content in _assets(node):
        written.append(folder / name)
        write_file(written[-1], content)
    return written


def _assets(node: NotebookNode) -> Iterator[tuple[str, bytes]]:
    outputs = [output for cell in node.cells for output in cell.get("outputs", []) if "data" in output]
    for output in outputs:
        for mime, kinds in ((table.MIME, ("csv", "latex")), (figure.MIME, ("svg", "pdf"))):
            found = output["data"].get(mime)
            for kind in kinds if found else ():
                yield f"{found['name']}.{_SUFFIX.get(kind, kind)}", _content(found[kind], kind)


_SUFFIX = {"latex": "tex"}


def _content(text: str, kind: str) -> bytes:
    return binascii.a2b_base64(text) if kind == "pdf" else text.encode()
