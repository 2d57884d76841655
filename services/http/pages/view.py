"""One view of the data: as a page, as JSON and, where it is a table, as CSV."""

import csv
import hashlib
import io
import re
from collections.abc import Awaitable, Callable, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cache, partial
from pathlib import Path
from typing import Any, Final
from urllib.parse import quote, urlencode

import jinja2
from markupsafe import Markup, escape
from starlette.requests import Request
from starlette.responses import HTMLResponse, JSONResponse, Response
from starlette.routing import Route

from sdt_kg.errors import UnknownEntityError
from sdt_kg.iri import local_name
from services.http.pages.kinds import MARKS
from services.http.pages.session import may_write
from services.http.pages.terms import id_link
from services.http.problems import RefusedError
from services.http.protocol.negotiate import HTML, accepted

FOLDER: Final = Path(__file__).resolve().parent.parent
JSON: Final = "application/json"
CSV: Final = "text/csv"
MEDIA: Final = {"json": JSON, "csv": CSV}
STATIC: Final = {
    "pages.css": "text/css; charset=utf-8",
    "pages.js": "text/javascript; charset=utf-8",
    "icon.svg": "image/svg+xml",
}
"""File → media type: all that a page asks for besides itself."""
KEPT: Final = "public, max-age=31536000, immutable"
BREAK: Final = re.compile(r"[_/.:#](?=\S)")
"""After these a long name may go on in the next line."""
FIGURE: Final = re.compile(
    r"(?<![\w./-])[-+]?\d+(?:[.,]\d+)*(?:e[-+]?\d+)?"
    r"(?: ?(?:mm|m|ms|s|rad|°|%|Nm|N|kg|J|W|KiB)(?:/s)?[²2]?)?(?!\w)"
)
"""A number with its unit, and no part of a name."""
SCRIPTED: Final = (
    "default-src 'none'; style-src 'self'; img-src 'self'; script-src 'self'; connect-src 'self'; "
    "form-action 'self'; frame-ancestors 'none'; base-uri 'none'"
)
"""Content-Security-Policy of a page with our script; others have none at all."""

Json = dict[str, Any]  # JSON object
Row = Mapping[str, Any]  # texts, numbers, truths


@dataclass(frozen=True, slots=True)
class View:
    """What a page shows.

    Attributes:
        template: Name of its template.
        data: What the page's JSON is, and what its template gets.
        rows: What the page's CSV is; None where the page is no table.
        columns: Of the CSV.
        shown: What the template gets beside the data.
        script: Whether the page has our script, which it does not need.
    """

    template: str
    data: Json
    rows: Sequence[Row] | None = None
    columns: Sequence[str] = ()
    shown: Json = field(default_factory=dict[str, Any])
    script: bool = False


Viewing = Callable[[Request], Awaitable[View]]


def routes(path: str, viewing: Viewing, *, table: bool = True, plain: str = "") -> list[Route]:
    """The page at its path, and its data at the path with `.json` and `.csv`.

    Args:
        path: Of the page.
        viewing: Makes it.
        table: Whether it has a CSV.
        plain: Path of the data without its ending, where it is not the page's own.
    """
    forms = ("json", "csv") if table else ("json",)
    stem = plain or path
    return [
        *(Route(f"{stem}.{form}", partial(_viewed, viewing, table, MEDIA[form])) for form in forms),
        Route(path, partial(_viewed, viewing, table, None)),
    ]


async def _viewed(viewing: Viewing, table: bool, media: str | None, request: Request) -> Response:
    """The view, in the form that its URL or else its reader wants."""
    offers = (HTML, JSON, CSV) if table else (HTML, JSON)
    if media is None:
        taken = accepted(request.headers.get("accept"), offers)
        if not taken:
            raise RefusedError(406, "none of the accepted media types is offered", allowed=", ".join(offers))
        media = taken[0]
    request.state.media = media
    return answered(request, await viewing(request), media)


def answered(request: Request, view: View, media: str) -> Response:
    """A view as HTML, JSON or CSV."""
    headers = {"Vary": "Accept"}
    if media == JSON:
        return JSONResponse(view.data, headers=headers)
    if media == CSV and view.rows is not None:
        return Response(csv_text(view.rows, view.columns), 200, headers, "text/csv; charset=utf-8")
    if view.script:
        headers["Content-Security-Policy"] = SCRIPTED
    return HTMLResponse(page(request, view), 200, headers)


def page(request: Request, view: View) -> str:
    """A view as HTML."""
    forms = ["json"] if view.rows is None else ["json", "csv"]
    here = path_of(request)
    stem = "/index" if here == "/" else here
    more = f"?{request.scope['query_string'].decode('latin-1')}" if request.scope["query_string"] else ""
    return template(view.template).render(
        {"forms": [(form, f"{stem}.{form}{more}") for form in forms]}
        | view.data
        | view.shown
        | around(request)
        | {"script": view.script}
    )


def around(request: Request) -> Json:
    """What every page says beside its subject."""
    state = request.app.state
    return {
        "served": list(state.world.kitchens),
        "viewer": state.settings.viewer,
        "guarded": state.settings.token is not None,
        "writes": may_write(request),
        "here": here(request),
    }


def here(request: Request, **changes: str | Sequence[str] | None) -> str:
    """This view's path and query, with other parameters; None leaves one out."""
    kept = [(name, value) for name, value in request.query_params.multi_items() if name not in changes]
    for name, value in changes.items():
        values = [value] if isinstance(value, str) else (value or [])
        kept += [(name, each) for each in values if each]
    return path_of(request) + (f"?{urlencode(kept)}" if kept else "")


def path_of(request: Request) -> str:
    """This view's path as it was asked for: a slash in a name, `%2F`, parts nothing."""
    raw: bytes = request.scope.get("raw_path") or quote(request.scope["path"]).encode()
    return raw.decode("ascii", "replace").partition("?")[0]


def sorted_by(request: Request, columns: Sequence[str]) -> str:
    """The column by which the address wants a table sorted; the first, where it says nothing.

    Raises:
        UnknownEntityError: No such column.
    """
    by = request.query_params.get("sort") or columns[0]
    if by not in columns:
        raise UnknownEntityError("column to sort by", by, columns)
    return by


def csv_text(rows: Sequence[Row], columns: Sequence[str]) -> str:
    """Rows as CSV with a head; truths as `true` and `false`, nothing as the empty text."""
    out = io.StringIO()
    writer = csv.writer(out, lineterminator="\r\n")  # RFC 4180
    writer.writerow(columns)
    writer.writerows([_csv_cell(row.get(column)) for column in columns] for row in rows)
    return out.getvalue()


def _csv_cell(value: object) -> object:
    if isinstance(value, bool):
        return str(value).lower()
    if isinstance(value, list | tuple):
        return " ".join(map(str, value))  # pyright: ignore[reportUnknownArgumentType]  # of a JSON value
    return "" if value is None else value


async def static(request: Request) -> Response:
    """A file of the pages; its address has the hash of its content."""
    name = request.path_params["name"]
    if name not in STATIC:
        raise RefusedError(404, f"there is no file '{name}'", allowed=", ".join(STATIC))
    return Response(_static(name), 200, {"Cache-Control": KEPT}, STATIC[name])


@cache
def _static(name: str) -> bytes:
    return (FOLDER / "static" / name).read_bytes()


def static_link(name: str) -> str:
    """Address of a file of the pages."""
    return f"/static/{name}?{hashlib.sha256(_static(name)).hexdigest()[:12]}"


@cache
def template(name: str) -> jinja2.Template:
    """A template of the folder."""
    environment = jinja2.Environment(
        loader=jinja2.FileSystemLoader(FOLDER / "templates"),
        autoescape=True,
        undefined=jinja2.StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
    )
    environment.globals |= {"static": static_link, "marks": MARKS}
    environment.filters |= {
        "breakable": breakable,
        "id_link": id_link,
        "local": local_name,
        "query": query_text,
    }
    return environment.get_template(f"{name}.html")


def query_text(words: Mapping[str, str | None]) -> str:
    """The query of an address; what is empty is left out."""
    return urlencode({name: value for name, value in words.items() if value})


def breakable(text: str) -> Markup:
    """Text whose names may break after underscores, slashes and dots, and whose figures never do.

    A figure is a number with its unit: nobody reads `6.` and `0 mm` on two lines as one.
    """
    between = FIGURE.split(text)
    figures = [Markup('<span class="figure">{}</span>').format(each) for each in FIGURE.findall(text)]
    names = [escape(BREAK.sub("\\g<0>\u200b", each)) for each in between]
    return Markup("").join(each for pair in zip(names, [*figures, ""], strict=True) for each in pair)
