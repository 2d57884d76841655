"""An agent at a server of its own, over kitchen b."""

import asyncio
import threading
from collections.abc import Iterator
from concurrent.futures import Future
from dataclasses import dataclass
from typing import Any

import pytest
from mcp import Client
from mcp.types import CallToolResult, Tool

from services.mcp_server.desk import Setup
from services.mcp_server.server import server

SETUP = Setup(("b",), ("pr2", "stretch"))
PATIENCE = 120.0  # [s]


@dataclass(frozen=True)
class Agent:
    """Who asks the server; its session lives in a thread of its own."""

    client: Client
    loop: asyncio.AbstractEventLoop

    def ask(self, tool: str, /, **given: Any) -> "Future[CallToolResult]":
        """The answer, when it comes."""
        return asyncio.run_coroutine_threadsafe(self.client.call_tool(tool, given), self.loop)

    def __call__(self, tool: str, /, **given: Any) -> CallToolResult:
        return self.ask(tool, **given).result(PATIENCE)

    def tools(self) -> list[Tool]:
        """What the server offers."""
        return asyncio.run_coroutine_threadsafe(self.client.list_tools(), self.loop).result(PATIENCE).tools


@pytest.fixture(scope="package")
def agent() -> Iterator[Agent]:
    """A session with the server, until all tests of the folder are done."""
    there: Future[tuple[Agent, asyncio.Event]] = Future()

    async def session() -> None:
        try:
            async with Client(server(SETUP)) as client:
                done = asyncio.Event()
                there.set_result((Agent(client, asyncio.get_running_loop()), done))
                await done.wait()
        except BaseException as error:
            if not there.done():
                there.set_exception(error)
            raise

    thread = threading.Thread(target=lambda: asyncio.run(session()))
    thread.start()
    found, done = there.result(PATIENCE)
    yield found
    found.loop.call_soon_threadsafe(done.set)
    thread.join(PATIENCE)
    assert not thread.is_alive()
