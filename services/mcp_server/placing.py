"""The tool that says where a robot's base may stand."""

from typing import Final

from services.mcp_server import arguments
from services.mcp_server.desk import FIRST, Desk
from services.mcp_server.judging import head_of
from services.mcp_server.report import Report

MOST_DIAGNOSES: Final = 5
"""Of a placement in a report."""
MORE: Final = "'verify_motion' with 'base' and drive fixed asks from one of them"


async def place(desk: Desk, asked: arguments.Place) -> Report:
    """Certified base poses, the best first, and in words the map of what is known about others."""
    reply = await desk.judge(head_of(desk, "place", asked), FIRST + asked.budget)
    said = reply["placement"]
    data = {name: said[name] for name in ("container", "spots", "impossible", "tried")}
    data["diagnoses"] = said["diagnoses"][:MOST_DIAGNOSES]
    return Report(tuple(reply["lines"]), data, "spots", MORE)
