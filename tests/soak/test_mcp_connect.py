"""`sdt mcp --connect`: an agent's tools, answered by oracles behind a router, each a process of its own."""

import asyncio
import subprocess
import sys
from collections.abc import Iterator
from contextlib import ExitStack
from typing import Any

import pytest
from mcp import Client, StdioServerParameters

from services.app import load
from services.motions.files import arrays_of
from tests.ports import free_endpoint

pytestmark = pytest.mark.oracle

SDT = ("-m", "services.cli")
DRAWER = "sink_area_left_middle_drawer_main"
STARTED = " at tcp/"


@pytest.fixture(scope="module")
def oracles() -> Iterator[tuple[str, dict[str, subprocess.Popen[str]]]]:
    """Endpoint of a router, and the oracles behind it by kind."""
    endpoint = free_endpoint()
    commands = {
        "router": ["router", "--listen", endpoint],
        "causes": ["oracle", "causes", "--connect", endpoint],
        "canperform": ["oracle", "canperform", "--connect", endpoint],
    }
    with ExitStack() as ended:
        processes: dict[str, subprocess.Popen[str]] = {}
        for name, words in commands.items():
            process = subprocess.Popen([sys.executable, *SDT, *words], stderr=subprocess.PIPE, text=True)
            ended.enter_context(process)
            ended.callback(process.kill)
            assert process.stderr is not None
            assert STARTED in process.stderr.readline()
            processes[name] = process
        yield endpoint, processes


def asked(endpoint: str, tool: str, *calls: dict[str, Any]) -> list[Any]:
    """Answers of a tool of `sdt mcp --connect`, one after the other."""
    words = [*SDT, "mcp", "--kitchen", "b", "--robot", "pr2", "--connect", endpoint]

    async def session() -> list[Any]:
        async with Client(StdioServerParameters(command=sys.executable, args=words)) as client:
            return [await client.call_tool(tool, call) for call in calls]

    return asyncio.run(session())


def test_an_agents_motion_is_verified_by_the_oracles_as_in_process(
    oracles: tuple[str, dict[str, subprocess.Popen[str]]],
) -> None:
    here = load("b", ["pr2"])
    (caused,) = here.causes(f"open:{DRAWER}")
    given = {name: value.tolist() for name, value in arrays_of(caused.case.motion).items()}
    (made,) = here.achieve(f"open:{DRAWER}", motion=caused.case.motion)
    call = {"task": f"open:{DRAWER}", "motion": given}
    first, again = asked(oracles[0], "verify_motion", call, call)
    assert not first.is_error, first.content
    (verdict,) = first.structured_content["verdicts"]
    assert (verdict["iri"], verdict["outcome"]) == (made.iri, made.outcome.value)
    assert again.structured_content["verdicts"][0]["stored"]


def test_without_an_oracle_there_is_no_verdict_and_the_agent_is_told(
    oracles: tuple[str, dict[str, subprocess.Popen[str]]],
) -> None:
    endpoint, processes = oracles
    processes["canperform"].kill()
    processes["canperform"].wait()
    motion = {"joint": f"{DRAWER}_joint", "times": [0.0, 8.0], "values": [0.0, 0.4], "timed": False}
    (answer,) = asked(endpoint, "verify_motion", {"task": f"open:{DRAWER}", "motion": motion})
    assert answer.is_error
    assert answer.structured_content["error"]["type"] == "unavailable"
    assert "no oracle for canperform" in answer.structured_content["error"]["what"]
