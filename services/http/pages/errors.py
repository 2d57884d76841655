"""Errors on pages: the words of the problem document, which are those of the shell."""

import json

from starlette.requests import Request
from starlette.responses import HTMLResponse, Response

from services.http.pages.view import View, page
from services.http.problems import MEDIA
from services.http.protocol.negotiate import HTML, accepted

FOR_MACHINES = ("/api/", "/sparql", "/graphs")


def told(request: Request, problem: Response) -> Response:
    """The problem as a page, for who reads pages."""
    path: str = request.scope["path"]
    wanted = accepted(request.headers.get("accept"), (MEDIA, HTML))
    if path.startswith(FOR_MACHINES) or not wanted or wanted[0] != HTML:
        return problem
    document = {"allowed": "", "remedy": "", "limit": ""} | json.loads(bytes(problem.body))
    kept = {
        name: value
        for name, value in problem.headers.items()
        if name not in {"content-type", "content-length"}
    }
    body = page(request, View("error", {}, None, (), document))
    return HTMLResponse(body, problem.status_code, kept)
