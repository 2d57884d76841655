"""The awaited client gives the same objects and raises the same errors, with several questions at once."""

import asyncio

import pytest

from services import connect_async
from services.bus.client import Connection
from services.bus.server import Server
from services.judging.problems import BusUnavailableError, RequestError
from tests.ports import free_endpoint

pytestmark = pytest.mark.oracle


def test_questions_are_awaited_together(bus: tuple[str, Server], connection: Connection) -> None:
    async def asked() -> None:
        async with connect_async("b", bus[0], deadline=120.0) as to:
            answers = await asyncio.gather(
                to.satisfies(), to.ask("ASK { ?d a sdt:Door }"), to.satisfies("all=open"), to.servers()
            )
            assert answers == [
                connection.satisfies(),
                True,
                connection.satisfies("all=open"),
                connection.servers(),
            ]
            about = "open:iai_fridge_door", ["drive:fixed"], "pr2"
            other, one = await asyncio.gather(to.whatif(*about, seed=4), to.achieve(about[0], "pr2", seed=4))
            assert other["actual"]["iri"] == one.stored[0].iri
            assert (await to.story(one.stored[0].iri)).text == await to.why(one.stored[0].iri)
            with pytest.raises(RequestError, match="no joint or container named 'nothing'"):
                await to.satisfies("nothing=open")

    asyncio.run(asked())


def test_nobody_there_is_an_error_before_anything_is_asked() -> None:
    async def asked() -> None:
        async with connect_async("b", free_endpoint()):
            pytest.fail("nobody listens there")

    with pytest.raises(BusUnavailableError):
        asyncio.run(asked())
