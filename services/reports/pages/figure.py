"""Figures for a page as SVG, and for a paper as SVG and PDF."""

import base64
import html
import io
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from typing import Any

import matplotlib as mpl
from matplotlib.figure import Figure as Drawing

MIME = "application/vnd.sdt.figure+json"
"""Under which a notebook's output carries the figure's SVG and PDF."""

COLUMN = 7.0
"""[in] Width of a figure: two columns of a paper."""

DPI = 200
"""[1/in] Of what is not drawn in lines."""

STYLE: Any = {  # Any: matplotlib names its keys by a type of its own
    "font.family": "DejaVu Sans",
    "font.size": 8.0,
    "axes.titlesize": 8.0,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "axes.linewidth": 0.6,
    "axes.grid": True,
    "axes.axisbelow": True,
    "grid.color": "#e3e3e6",
    "grid.linewidth": 0.5,
    "legend.frameon": False,
    "lines.linewidth": 1.2,
    "pdf.fonttype": 42,  # text stays text
    "svg.hashsalt": "sdt",  # the same figure is the same file
}


@dataclass(frozen=True, slots=True, eq=False)
class Figure:
    """A drawing with a name and a caption.

    Attributes:
        name: Stem of its files.
        caption: A sentence or two: what is seen, and what it means.
        drawing: Matplotlib's.
    """

    name: str
    caption: str
    drawing: Drawing

    def saved(self, form: str) -> bytes:
        """As `svg`, `pdf` or `png`; the same bytes for the same drawing."""
        out = io.BytesIO()
        dated = {"svg": {"Date": None}, "pdf": {"CreationDate": None, "ModDate": None}}.get(form, {})
        with mpl.rc_context(STYLE):
            self.drawing.savefig(out, format=form, dpi=DPI, metadata=dated)
        self.drawing.set_layout_engine("none")  # laid out now, and not once more for the next form
        return out.getvalue()

    def html(self, svg: bytes) -> str:
        """As an image that is in the page, with its caption."""
        data, caption = base64.b64encode(svg).decode(), html.escape(self.caption)
        return (
            f'<figure class="sdt-figure"><img alt="{caption}" src="data:image/svg+xml;base64,{data}">'
            f"<figcaption>{caption}</figcaption></figure>"
        )

    def _repr_mimebundle_(self, include: object = None, exclude: object = None) -> dict[str, object]:
        del include, exclude
        svg, pdf = self.saved("svg"), base64.b64encode(self.saved("pdf")).decode()
        return {
            "text/html": self.html(svg),
            "text/plain": self.caption,
            MIME: {"name": self.name, "svg": svg.decode(), "pdf": pdf},
        }


@contextmanager
def drawn(height: float, width: float = COLUMN) -> Iterator[Drawing]:
    """An empty drawing of a size [in], in the style of all figures."""
    with mpl.rc_context(STYLE):
        yield Drawing(figsize=(width, height), layout="constrained")
