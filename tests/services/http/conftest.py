"""The service in this process, over the small kitchens and over what a test seeds."""

from collections.abc import Callable, Iterator
from contextlib import ExitStack
from dataclasses import dataclass, replace

import httpx
import pytest
from anyio.from_thread import BlockingPortal, start_blocking_portal

from services.http.app import create_app
from services.http.kitchens import open_kitchens
from services.http.settings import Settings
from services.http.world import World
from services.store.quads import QuadStore
from services.store.workers import Delta, Limits, Workers
from tests.small import FOLDER

HOST = "www.example"


@dataclass(frozen=True)
class Served:
    """A running service, as a client sees it and as it is inside; its event loop is in another thread."""

    portal: BlockingPortal
    client: httpx.AsyncClient
    world: World

    def request(self, method: str, path: str, **parts: object) -> httpx.Response:
        async def sent() -> httpx.Response:
            return await self.client.request(method, path, **parts)

        return self.portal.call(sent)

    def get(self, path: str, **parts: object) -> httpx.Response:
        return self.request("GET", path, **parts)

    def post(self, path: str, **parts: object) -> httpx.Response:
        return self.request("POST", path, **parts)

    def query(self, text: str, **parts: object) -> httpx.Response:
        return self.get("/sparql", params={"query": text}, **parts)

    def apply(self, *deltas: Delta) -> None:
        """Seed through the store."""
        for delta in deltas:
            self.portal.call(self.world.workers.apply, delta)


Serve = Callable[..., Served]


@pytest.fixture(scope="module")
def serve() -> Iterator[Serve]:
    """`serve(kitchens=["a"], robots=["pr2"], …)` → a running service, ended with the module."""
    with start_blocking_portal() as portal, ExitStack() as ended:

        def start(
            kitchens: tuple[str, ...] = (),
            robots: tuple[str, ...] = (),
            limits: Limits | None = None,
            workers: int = 1,
            archive: QuadStore | None = None,
            **settings: object,
        ) -> Served:
            sources = [str(FOLDER / f"{name}.urdf") for name in kitchens]
            models = tuple(str(FOLDER / f"{name}.urdf") for name in robots)
            world = World(open_kitchens(sources, models), Workers(workers, limits or Limits()), archive)
            allowed = replace(Settings(hosts=frozenset({HOST, "localhost"})), **settings)
            app = create_app(world, allowed)
            ended.enter_context(portal.wrap_async_context_manager(app.router.lifespan_context(app)))
            transport = httpx.ASGITransport(app=app, raise_app_exceptions=False)
            return Served(portal, httpx.AsyncClient(transport=transport, base_url=f"http://{HOST}"), world)

        yield start
