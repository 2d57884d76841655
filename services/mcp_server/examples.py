"""Calls that work on what is loaded, for agents that have not seen it before."""

from dataclasses import dataclass
from typing import Any, Final

from predicates.meant import counted
from sdt_kg.errors import InputError
from sdt_kg.iri import local_name
from sdt_kg.twin import Container
from services.mcp_server import arguments
from services.mcp_server.desk import Desk
from services.mcp_server.report import Json, Report

SLOWLY: Final = 3.0
"""[1] A motion takes so many times what the velocity limit asks for, and at least MOST_QUICK."""
MOST_QUICK: Final = 8.0
"""[s] No container's motion in an example is shorter."""
CONTAINERS: Final = """SELECT ?container ?label ?joint ?upper WHERE {
  ?container a sdt:Container ; rdfs:label ?label ; sdt:hasJoint ?joint . ?joint sdt:upperLimit ?upper . }"""
VERDICTS: Final = """SELECT ?verdict ?outcome ?reason WHERE {
  ?verdict a law:Verdict ; law:outcome ?outcome . OPTIONAL { ?verdict law:diagnosis/law:reason ?reason } }"""
GRIPPERS: Final = "SELECT ?robot ?gripper WHERE { ?robot sdt:hasGripper ?gripper }"


@dataclass(frozen=True, slots=True)
class Example:
    """One call.

    Attributes:
        tool: Its name.
        given: Its arguments.
        what: One sentence.
    """

    tool: str
    given: dict[str, Any]  # JSON
    what: str


async def examples(desk: Desk, asked: arguments.Examples) -> Report:
    """Queries and calls with names of this kitchen."""
    found = calls(desk)
    names = sorted({each.tool for each in found})
    if asked.tool is not None and asked.tool not in names:
        raise InputError(f"no examples of '{asked.tool}'", allowed=", ".join(names))
    shown = [each for each in found if asked.tool in (None, each.tool)]
    data: Json = {
        "examples": [{"tool": each.tool, "what": each.what, "arguments": each.given} for each in shown]
    }
    lines = [f"{each.tool}: {each.what}\n  {each.given}" for each in shown]
    return Report(tuple(lines), data, "examples", "ask with 'tool'")


def calls(desk: Desk) -> list[Example]:
    """Examples for the first kitchen, its first container and its first robot."""
    name, service = next(iter(desk.services.items()))
    twin = service.twin
    container, robots = counted(twin)[0], [twin.name(each) for each in twin.robots]
    where: dict[str, Any] = {"kitchen": name}
    found = [
        Example("lookup", {"name": container.name, **where}, "an entity by name, with joint and limits"),
        Example("schema", {"term": "hasJoint"}, "what a term means"),
        Example("select", {"query": CONTAINERS}, "containers and how far they go"),
        Example("select", {"query": GRIPPERS}, "which grippers there are"),
        Example("select", {"query": VERDICTS}, "the verdicts of this session, and why"),
        Example("list_scopes", where, "about what the Law says anything at all"),
    ]
    if not robots:
        return found
    case = {"task": f"open:{container.name}", "robot": robots[0], **where}
    return [
        *found,
        Example(
            "verify_motion",
            {**case, "motion": motion(container)},
            "is there a body motion for this motion of the container?",
        ),
        Example("what_if", {**case, "edits": ["drive:fixed"]}, "the same with a base that stands still"),
        Example("place", case, "where the base may stand for that, so that it need not move"),
        Example("diagnose", {"verdict": "IRI of a verdict", "section": "Reasons"}, "why, in plain words"),
    ]


def motion(container: Container) -> dict[str, Any]:  # JSON
    """τ from closed to open, which the robot may follow more slowly."""
    way = container.upper - container.lower
    seconds = max(MOST_QUICK, SLOWLY * way / container.velocity)
    to = container.lower + 0.5 * (way + container.open_from - container.lower)
    ends = ((each - container.offset) / container.multiplier for each in (container.lower, to))
    return {
        "joint": local_name(container.active_joint),
        "times": [0.0, round(seconds, 3)],
        "values": [round(each, 6) for each in ends],
        "timed": False,
    }
