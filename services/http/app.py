"""The web application: routes, gate and life of the workers."""

import asyncio
import platform
from collections.abc import AsyncIterator, Callable
from contextlib import AbstractContextManager, asynccontextmanager, nullcontext
from dataclasses import replace
from functools import partial
from importlib.metadata import version
from typing import Protocol

from fastapi import FastAPI
from starlette.requests import Request
from starlette.responses import JSONResponse, Response
from starlette.routing import Route

from services.app import Oracles
from services.http import problems
from services.http.api import read, write
from services.http.gate import Gate
from services.http.judges import Judges, setup_of
from services.http.memory import Memory
from services.http.observed import Observed, metrics
from services.http.pages.asking import Asking
from services.http.pages.errors import told
from services.http.pages.session import Sessions
from services.http.pages.site import site
from services.http.pages.view import routes
from services.http.pages.writing.recheck import Rechecks
from services.http.protocol.graphs import graphs
from services.http.protocol.openapi import document
from services.http.protocol.sparql import sparql
from services.http.resources import about, identified
from services.http.settings import Settings
from services.http.world import World
from services.judging.workers.pool import Pool


class Beside(Protocol):
    """What is served beside HTTP, over the same world and by the same processes.

    Attributes:
        oracles: How those processes get their oracles; None: they judge by themselves.
    """

    @property
    def oracles(self) -> Callable[[], Oracles] | None: ...

    def __call__(
        self, world: World, pool: Pool, loop: asyncio.AbstractEventLoop
    ) -> AbstractContextManager[object]:
        """Serve until the context ends; the world's workers belong to the loop."""
        ...


def create_app(world: World, settings: Settings, beside: Beside | None = None) -> FastAPI:
    """The application over a world; its workers live as long as it runs."""

    @asynccontextmanager
    async def life(app: FastAPI) -> AsyncIterator[None]:
        loop = asyncio.get_running_loop()
        setup = replace(setup_of(world), oracles=beside.oracles if beside else None)
        pool = Pool(setup, settings.judges, Memory(world, loop), telemetry=settings.telemetry)
        judges = app.state.judges = Judges(pool)
        await world.start()
        other = beside(world, pool, loop) if beside else nullcontext()
        warming = None
        try:
            await asyncio.to_thread(other.__enter__)
            warming = asyncio.create_task(judges.warm()) if settings.warm else None
            yield
        finally:
            await asyncio.to_thread(other.__exit__, None, None, None)
            await app.state.asking.close()
            if warming is not None:
                await asyncio.wait([warming])
            await judges.close()
            await world.close()

    app = FastAPI(
        title="sdt",
        description="Semantic digital twins in SPARQL, and verdicts about body motions.",
        version=version("sdt-kg"),
        docs_url=None,
        redoc_url=None,
        lifespan=life,
    )
    app.state.world, app.state.settings, app.state.telemetry = world, settings, settings.telemetry
    app.state.asking, app.state.rechecks, app.state.sessions = Asking(app), Rechecks(world), Sessions()
    problems.install(app, told)
    app.router.routes += [
        *site(),
        Route("/sparql", sparql, methods=["GET", "POST"]),
        Route("/sparql/", sparql, methods=["GET", "POST"]),
        Route("/graphs", graphs),
        Route("/graphs/{name:path}", graphs),
        Route("/id/{name:path}", identified),
        *routes("/about", about),
        Route("/healthz", _health),
        Route("/readyz", _ready),
        Route("/version", _version),
        Route("/metrics", metrics),
    ]
    app.include_router(read.router)
    app.include_router(write.router)
    app.openapi = partial(document, app)
    app.add_middleware(Gate, settings=settings, told=told)
    app.add_middleware(Observed, telemetry=settings.telemetry)
    return app


async def _health(request: Request) -> Response:
    """The process answers."""
    return JSONResponse({"status": "alive"})


async def _ready(request: Request) -> Response:
    """Queries are answered."""
    workers = request.app.state.world.workers
    if not workers.running:
        return problems.problem(
            503, "Not ready", "the process that holds the data has ended: restart the service"
        )
    return JSONResponse({"status": "ready", "workers": workers.count, "network_namespace": workers.namespace})


async def _version(request: Request) -> Response:
    names = ("sdt-kg", "pyoxigraph", "rdflib", "fastapi", "uvicorn")
    return JSONResponse({name: version(name) for name in names} | {"python": platform.python_version()})
