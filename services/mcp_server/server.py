"""The MCP server: nine tools that read, each answer short, each failure typed."""

import logging
from collections.abc import AsyncIterator, Awaitable, Callable
from contextlib import asynccontextmanager
from dataclasses import dataclass
from importlib.metadata import version
from typing import Any, Final

from mcp.server.lowlevel import Server
from mcp.server.stdio import stdio_server
from mcp.types import (
    CallToolRequestParams,
    CallToolResult,
    ListToolsResult,
    PaginatedRequestParams,
    TextContent,
    Tool,
    ToolAnnotations,
)
from pydantic import ValidationError

from sdt_kg.errors import InputError, SdtError
from services.app import Service
from services.http.problems import RefusedError
from services.judging.problems import RETRYABLE, ProblemType
from services.judging.queried import problem_of_query
from services.mcp_server import arguments, examples, judging, otherwise, placing, reading
from services.mcp_server.desk import Desk, Setup, opened
from services.mcp_server.report import LIMIT, Json, Report

INSTRUCTIONS: Final = (
    "Certifies that a robot's body motion achieves a task in a kitchen (open or close a door or drawer). "
    "Propose a motion, call verify_motion, read the typed diagnoses (quantity, value, bound, time, entity), "
    "repair what they name, verify again. 'certified' is relative to the class that 'tee' names (D_artic) "
    "and to the models; "
    "'not_certified' is no proof of impossibility unless a diagnosis says proof; 'abstained' claims nothing. "
    "Begin with examples, lookup and list_scopes. SI units and radians."
)
READS: Final = ToolAnnotations(
    read_only_hint=True, destructive_hint=False, idempotent_hint=True, open_world_hint=False
)
_log = logging.getLogger("sdt.mcp")

Call = Callable[[Desk, Any], Awaitable[Report]]  # the tool's own arguments
Serving = Server[Desk]


@dataclass(frozen=True, slots=True)
class Offer:
    """One tool.

    Attributes:
        call: Answers.
        takes: Its arguments.
        what: For the agent that chooses among tools.
    """

    call: Call
    takes: type[arguments.Arguments]
    what: str


OFFERS: Final = {
    "lookup": Offer(
        reading.lookup, arguments.Lookup, "Entities of a kitchen and its robots by name or label."
    ),
    "schema": Offer(reading.schema, arguments.Schema, "The vocabulary in short, or what one term means."),
    "examples": Offer(
        examples.examples, arguments.Examples, "Queries and calls that work on what is loaded."
    ),
    "select": Offer(
        reading.select,
        arguments.Select,
        "SPARQL SELECT or ASK over twins, vocabularies and this session's verdicts; capped rows are told.",
    ),
    "list_scopes": Offer(
        reading.list_scopes,
        arguments.ListScopes,
        "TEE classes, and which containers are inside for which robot; outside of them the Law abstains.",
    ),
    "verify_motion": Offer(
        judging.verify_motion,
        arguments.VerifyMotion,
        "Does this motion achieve the task? Certified, not certified or abstained, with every reason: "
        "quantity, value, bound, time, entity. For a container's motion a body motion is searched; a robot's "
        "motion is verified as it is. Takes seconds.",
    ),
    "diagnose": Offer(judging.diagnose, arguments.Diagnose, "A verdict of this session in plain words."),
    "what_if": Offer(
        otherwise.what_if,
        arguments.WhatIf,
        "The same question in another world (robot, drive, base, limit, state): what turns? With 'turn' and "
        "no edits: which smallest change of any kind turns it? With 'grid': every combination of "
        "alternatives, for every container and robot. Takes seconds, a grid minutes.",
    ),
    "place": Offer(
        placing.place,
        arguments.Place,
        "Where may the robot's base stand so that it does the task without moving it? Certified poses, the "
        "best first, and a map of what is known of others. Takes seconds.",
    ),
}


def server(setup: Setup, services: dict[str, Service] | None = None) -> Serving:
    """The server over what the set-up names; its processes live as long as a session with it.

    Raises:
        InputError: A model that is not there or not valid.
    """
    loaded = setup.services() if services is None else services

    @asynccontextmanager
    async def lifespan(_: Serving) -> AsyncIterator[Desk]:
        async with opened(setup, loaded) as desk:
            yield desk

    return Server(
        "sdt",
        version=version("sdt-kg"),
        title="The Law of Task-Achieving Body Motion",
        instructions=INSTRUCTIONS,
        lifespan=lifespan,
        on_list_tools=_listed,
        on_call_tool=_called,
    )


async def serve(setup: Setup, services: dict[str, Service]) -> None:
    """Answer on standard input and output until the input ends."""
    serving = server(setup, services)
    async with stdio_server() as (incoming, outgoing):
        await serving.run(incoming, outgoing, serving.create_initialization_options())


async def _listed(context: object, params: PaginatedRequestParams | None) -> ListToolsResult:
    del context, params
    return ListToolsResult(
        tools=[
            Tool(
                name=name,
                description=f"{offer.what} At most {LIMIT} characters; what is left out is told.",
                input_schema=offer.takes.model_json_schema(),
                annotations=READS,
            )
            for name, offer in OFFERS.items()
        ]
    )


async def _called(context: Any, params: CallToolRequestParams) -> CallToolResult:  # noqa: ANN401 - generic over the session
    try:
        report = await _answer(context.lifespan_context, params.name, params.arguments or {})
    except SdtError as error:
        return failed(error)
    except Exception:  # noqa: BLE001 - the edge of a service: logged and answered
        _log.exception("the tool %r failed", params.name)
        return _failure(ProblemType.INTERNAL, "the server failed; its log says why", "", "")
    return CallToolResult(content=[TextContent(text=report.text())], structured_content=report.content())


async def _answer(desk: Desk, name: str, given: Json) -> Report:
    """The report of a tool.

    Raises:
        SdtError: No such tool, wrong arguments, or whatever the tool has to say.
    """
    if name not in OFFERS:
        raise InputError(f"no tool '{name}'", allowed=", ".join(OFFERS))
    offer = OFFERS[name]
    try:
        asked = offer.takes.model_validate(given)
    except ValidationError as error:
        wrong = "; ".join(
            f"'{'.'.join(map(str, each['loc']))}': {each['msg']}" for each in error.errors()[:5]
        )
        known = ", ".join(offer.takes.model_fields)
        raise InputError(
            f"wrong arguments of {name}: {wrong}", allowed=known, remedy="see 'examples'"
        ) from None
    return await offer.call(desk, asked)


def failed(error: SdtError) -> CallToolResult:
    """A typed failure: kind, what, allowed, remedy, and whether asking again may help."""
    # What is refused by the judges is late: see Desk.judge.
    kind = ProblemType.DEADLINE if isinstance(error, RefusedError) else problem_of_query(error).kind
    if isinstance(error, InputError):
        return _failure(kind, error.what, error.allowed, error.remedy)
    return _failure(kind, str(error), "", "ask again")


def _failure(kind: ProblemType, what: str, allowed: str, remedy: str) -> CallToolResult:
    parts = {"what": what[:1500], "allowed": allowed[:1500], "remedy": remedy[:500]}
    said = {"type": kind.value, **parts, "retryable": kind in RETRYABLE}
    text = "; ".join(f"{name}: {value}" for name, value in parts.items() if value)
    return CallToolResult(
        content=[TextContent(text=f"error ({kind.value}); {text}")],
        structured_content={"error": said},
        is_error=True,
    )
