"""Tables as HTML for a page, CSV for a spreadsheet and LaTeX for a paper."""

import csv
import html
import io
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from services.reports.scene.colors import COLORS, css

MIME = "application/vnd.sdt.table+json"
"""Under which a notebook's output carries the table's CSV and LaTeX."""

DARK = 0.45
"""[1] Backgrounds of less brightness have white text."""

LATEX_SIGNS = {
    "\\": r"\textbackslash{}",
    "&": r"\&",
    "%": r"\%",
    "$": r"\$",
    "#": r"\#",
    "_": r"\_",
    "{": r"\{",
    "}": r"\}",
    "~": r"\textasciitilde{}",
    "^": r"\textasciicircum{}",
    "→": r"$\rightarrow$",
    "≤": r"$\leq$",
    "≥": r"$\geq$",
    "±": r"$\pm$",
    "×": r"$\times$",
    "°": r"$^\circ$",
    "τ": r"$\tau$",
    "Φ": r"$\Phi$",
}


@dataclass(frozen=True, slots=True)
class Cell:
    """A value with a meaning.

    Attributes:
        value: What stands there; CSV and LaTeX have nothing else.
        color: Name in `colors.COLORS`; empty for none.
        clip: Name of a clip of the page's 3D view, shown when the cell is chosen.
        title: More in words, where there is a pointer to hover with.
    """

    value: object
    color: str = ""
    clip: str = ""
    title: str = ""


@dataclass(frozen=True, slots=True)
class Table:
    """Rows under named columns.

    Attributes:
        name: Stem of its files.
        caption: A sentence.
        columns: Heads.
        rows: As long as the heads; a `Cell` or a plain value.
    """

    name: str
    caption: str
    columns: tuple[str, ...]
    rows: tuple[tuple[object, ...], ...]

    @staticmethod
    def of(name: str, caption: str, rows: Sequence[Mapping[str, object]]) -> "Table":
        """The table of rows that have the same keys."""
        columns = tuple(rows[0]) if rows else ()
        return Table(name, caption, columns, tuple(tuple(each.values()) for each in rows))

    def csv(self) -> str:
        """As CSV with a head; numbers in full."""
        out = io.StringIO()
        writer = csv.writer(out, lineterminator="\n")
        writer.writerow(self.columns)
        writer.writerows([_plain(each) for each in row] for row in self.rows)
        return out.getvalue()

    def latex(self) -> str:
        """As a `tabular` with a caption; the paper uses the package booktabs."""
        numeric = [
            all(isinstance(_value(row[i]), int | float) for row in self.rows)
            for i in range(len(self.columns))
        ]
        lines = [
            r"\begin{table}",
            r"\centering",
            rf"\caption{{{_latex(self.caption)}}}",
            rf"\begin{{tabular}}{{{''.join('r' if each else 'l' for each in numeric)}}}",
            r"\toprule",
            " & ".join(map(_latex, self.columns)) + r" \\",
            r"\midrule",
            *(" & ".join(_latex(shown(_value(each))) for each in row) + r" \\" for row in self.rows),
            r"\bottomrule",
            r"\end{tabular}",
            r"\end{table}",
        ]
        return "\n".join(lines) + "\n"

    def html(self) -> str:
        """As a table with a caption."""
        head = "".join(f'<th scope="col">{_breakable(each)}</th>' for each in self.columns)
        body = "".join("<tr>" + "".join(map(_cell, row)) + "</tr>" for row in self.rows)
        if not self.rows:
            body = f'<tr><td colspan="{max(1, len(self.columns))}">none</td></tr>'
        # The words stay where they are while a wide table is scrolled.
        caption = f"<caption><span>{html.escape(self.caption)}</span></caption>"
        parts = f"{caption}<thead><tr>{head}</tr></thead><tbody>{body}</tbody>"
        label = html.escape(self.caption, quote=True)
        # Where it is wider than the page, it is scrolled by keyboard too.
        region = f'<div class="sdt-table" tabindex="0" role="region" aria-label="{label}">'
        return f"{region}<table>{parts}</table></div>"

    def _repr_mimebundle_(self, include: object = None, exclude: object = None) -> dict[str, object]:
        del include, exclude
        return {
            "text/html": self.html(),
            "text/plain": self.csv(),
            MIME: {"name": self.name, "csv": self.csv(), "latex": self.latex()},
        }


def shown(value: object) -> str:
    """A value as people read it: four digits, yes and no, nothing for None."""
    if value is None:
        return ""
    if isinstance(value, bool):
        return "yes" if value else "no"
    return f"{value:.4g}" if isinstance(value, float) else str(value)


def _value(cell: object) -> object:
    return cell.value if isinstance(cell, Cell) else cell


def _plain(cell: object) -> str:
    value = _value(cell)
    return "" if value is None else ("yes" if value else "no") if isinstance(value, bool) else str(value)


def _cell(cell: object) -> str:
    value = _value(cell)
    text, style, title = _breakable(shown(value)), "", ""
    number = ' class="number"' if isinstance(value, int | float) and not isinstance(value, bool) else ""
    if isinstance(cell, Cell):
        title = f' title="{html.escape(cell.title)}"' if cell.title else ""
        if cell.color:
            ink = "#fff" if sum(COLORS[cell.color]) / 3 < DARK else "#1c1c1e"
            style = f' style="background:{css(cell.color)};color:{ink}"'
        if cell.clip:
            text = (
                f'<button type="button" class="sdt-clip" data-clip="{html.escape(cell.clip)}">{text}</button>'
            )
    return f"<td{number}{style}{title}>{text}</td>"


def _breakable(text: str) -> str:
    """As HTML in which a long name may break after its signs, and a hash within itself."""
    broken = re.sub(r"(?<=[^\s\d][_./:;=@,])(?=[^\s])", "<wbr>", html.escape(text))
    return re.sub(r"([0-9a-f]{16})(?=[0-9a-f]{16})", r"\1<wbr>", broken)


def _latex(text: str) -> str:
    return "".join(LATEX_SIGNS.get(sign, sign) for sign in text)
