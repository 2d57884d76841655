"""Forms of pages: ask for cases, check again what was judged, take a certificate or proof, sign in."""

from urllib.parse import quote

import pyoxigraph as ox
from starlette.requests import Request
from starlette.responses import RedirectResponse, Response

from predicates.record import read_verdict
from sdt_kg.errors import InputError
from sdt_kg.iri import Iri, local_name, task_result_iri, verdict_iri
from services.http.pages.asking import Asking
from services.http.pages.feasibility.asked import asked_about
from services.http.pages.feasibility.cells import cells_of, kept_verdicts
from services.http.pages.feasibility.matrix import UNANSWERED
from services.http.pages.session import check_may_write, local, posted_pairs
from services.http.pages.terms import id_link
from services.http.pages.view import View
from services.http.problems import RefusedError
from services.http.world import World

PATIENCE = 2.0
"""[s] One case is waited for, so that an easy one is there when the page comes back."""


async def ask(request: Request) -> Response:
    """What no verdict answers of these cases will be judged; back to the matrix.

    Fields: task, drive, state (any number) as the matrix has them; case, a robot and a container with `/`
    between, either may be left out and then means every one; next, the page to go back to.
    """
    check_may_write(request)
    pairs = await posted_pairs(request)
    form = dict(pairs)
    world: World = request.app.state.world
    asking: Asking = request.app.state.asking
    asked = asked_about(world.kitchen(request.path_params["kitchen"]), pairs)
    robot, _, container = form.get("case", "").partition("/")
    robots = [asked.kitchen.service.robot(robot)] if robot else list(asked.twin.robots)
    if container:
        asked.twin.container(container)
    kept = await kept_verdicts(world, asked)
    cells = [
        each
        for each in cells_of(asked, robots, kept.shown, asking)
        if container in {"", each["container"]} and each["standing"] in UNANSWERED
    ]
    wanted = (asked.wish(each["robot"], each["container"]) for each in cells)
    wishes = [each for each in wanted if each is not None]
    asking.ask(wishes)
    if len(wishes) == 1:
        await asking.over(wishes[0], PATIENCE)
    back = local(form["next"]) if form.get("next") else f"/kitchens/{quote(asked.kitchen.name)}"
    return RedirectResponse(f"{back}#{quote(robot)}.{quote(container)}" if robot and container else back, 303)


async def recheck(request: Request) -> Response:
    """The verdict is checked again; back to its page, which says what came of it."""
    return await _rechecked(request, verdict_iri(request.path_params["key"]))


async def recheck_result(request: Request) -> Response:
    """The same of a task's result."""
    return await _rechecked(request, task_result_iri(request.path_params["key"]))


async def _rechecked(request: Request, judged: Iri) -> Response:
    check_may_write(request)
    await request.app.state.rechecks.check(judged)
    return RedirectResponse(f"{id_link(judged)}#recheck", 303)


async def artefact(request: Request) -> Response:
    """The certificate or proof of a verdict, as a file that `sdt recheck` takes."""
    iri = verdict_iri(request.path_params["key"])
    world: World = request.app.state.world
    record = await world.recall(iri)
    if not record:
        raise RefusedError(404, f"no verdict <{iri}>", remedy="/verdicts lists them")
    stored = read_verdict(ox.parse(record, format=ox.RdfFormat.N_QUADS), iri)
    if stored.artefact is None:
        raise RefusedError(404, "this verdict has neither certificate nor proof")
    name = f"{local_name(iri)[:12]}.{stored.artefact.kind.value}"
    headers = {"Content-Disposition": f'attachment; filename="{name}"'}
    return Response(stored.artefact.content, 200, headers, "application/octet-stream")


async def sign_in_page(request: Request) -> View:
    """The form that takes the token."""
    if request.app.state.settings.token is None:
        raise InputError("nobody needs to sign in here", allowed="no token is set")
    shown = {
        "next": local(request.query_params.get("next", "")),
        "wrong": request.query_params.get("wrong") == "1",
    }
    return View("sign_in", {}, None, (), shown)
