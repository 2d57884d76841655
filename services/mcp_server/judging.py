"""Tools that judge: verify a motion, tell why in plain words."""

import asyncio
from collections.abc import Iterable
from itertools import zip_longest
from typing import Any, Final

import pyoxigraph as ox

from predicates.case import Outcome, Search
from predicates.record.report import WORDS, evidence_line
from sdt_kg.errors import InputError, UnknownEntityError
from sdt_kg.iri import Iri, verdict_iri
from services.mcp_server import arguments
from services.mcp_server.desk import FIRST, Desk
from services.mcp_server.judge import Head
from services.mcp_server.report import LIMIT, Json, Report, size
from services.why import Section, means, sections

MOST_MOTION: Final = 8_000_000
"""[characters] Of a motion as JSON."""
MOST_DIAGNOSES: Final = 12
"""Of one verdict in a report."""
MORE: Final = "'diagnose' with a verdict's IRI tells all of it"
SECTIONS: Final = ("Asked", "Answers", "Reasons", "Margins", "Notes", "Versions and inputs", "To check again")
HOLDS: Final = ("satisfies_request", "causes", "can_perform")
TOLD: Final = ("outcome", "task", "container", "robot", "kitchen", *HOLDS, "gripper", "drive", "stored")


async def verify_motion(desk: Desk, asked: arguments.VerifyMotion) -> Report:
    """Certified, not certified or abstained, with every reason."""
    length = size(asked.motion)
    if length > MOST_MOTION:
        raise InputError(
            f"the motion is {length} characters of JSON", allowed=f"{MOST_MOTION}", remedy="fewer samples"
        )
    head = head_of(desk, "verify", asked)
    reply = await desk.judge(head, FIRST + asked.budget)
    verdicts: list[Json] = reply["verdicts"]
    lines = [line for each in verdicts for line in verdict_lines(each)]
    claims = dict.fromkeys((verdict["outcome"], verdict["tee_class"]) for verdict in verdicts)
    lines += [means(Outcome(outcome), tee) for outcome, tee in claims]
    return Report(tuple(lines), fitted(verdicts), more=MORE)


async def diagnose(desk: Desk, asked: arguments.Diagnose) -> Report:
    """A verdict of this session in plain words."""
    iri = _known(desk, asked.verdict)
    quads = list(ox.parse(desk.kept[iri], format=ox.RdfFormat.N_QUADS))
    story = await asyncio.to_thread(sections, quads, iri, edits=desk.edited.get(iri, ()))
    titles = [each.title for each in story]
    if asked.section is not None:
        if asked.section not in SECTIONS:
            raise InputError(f"no section '{asked.section}'", allowed=", ".join(SECTIONS))
        story = tuple(each for each in story if each.title in (titles[0], asked.section))
        if len(story) == 1:
            story = (Section(titles[0], (f"It has nothing under {asked.section}.",)),)
    lines = [line for each in story for line in (each.title, *(f"  {line}" for line in each.lines))]
    more = f"ask with 'section': {', '.join(titles[1:])}"
    return Report(tuple(lines), {"iri": iri, "sections": titles}, more=more)


def verdict_lines(verdict: Json) -> list[str]:
    """Outcome, predicates and reasons with what they rest on."""
    holds = ", ".join(f"{name.replace('_', ' ')} {WORDS[verdict[name]]}" for name in HOLDS)
    reasons = [
        line
        for number, each in enumerate(telling(verdict["diagnoses"]), 1)
        for line in (f"{number}. {reason_line(each)}", *_measured(each["evidence"]))
    ]
    again = ["Judged before in this session; the answer is the same."] if verdict["stored"] else []
    return [
        headline(verdict),
        f"  {holds}; base {verdict['drive']}",
        *reasons,
        *again,
        f"verdict: {verdict['iri']}",
    ]


def fitted(verdicts: list[Json]) -> Json:
    """The verdicts as data of at most LIMIT characters; what is left out is counted."""
    for most in range(MOST_DIAGNOSES, -1, -1):
        data: Json = {"verdicts": [_shortened(each, most) for each in verdicts], "left_out": 0}
        if size(data) <= LIMIT:
            return data
    kept = list[Json]()
    for each in verdicts:
        kept.append(_shortened(each, 0))
        if size({"verdicts": kept, "left_out": len(verdicts)}) > LIMIT:
            kept.pop()
            break
    return {"verdicts": kept, "left_out": len(verdicts) - len(kept)}


def telling(diagnoses: list[Json]) -> list[Json]:
    """The worst of each kind and quantity first, then the next worst of each, and so on."""
    groups: dict[tuple[str, str], list[Json]] = {}
    for each in diagnoses:
        quantity = each["evidence"]["quantity"] if each["evidence"] else ""
        groups.setdefault((each["kind"], quantity), []).append(each)
    ranked = [sorted(group, key=_excess, reverse=True) for group in groups.values()]
    return [each for rank in zip_longest(*ranked) for each in rank if each is not None]


def _excess(diagnosis: Json) -> float:
    """By how much the bound is missed; nothing measured counts as nothing."""
    evidence = diagnosis["evidence"] or {}
    value, bound = evidence.get("value"), evidence.get("bound")
    return abs((value or 0.0) - (bound or 0.0))


def _shortened(verdict: Json, most: int) -> Json:
    shown = telling(verdict["diagnoses"])[:most]
    return {
        "iri": verdict["iri"],
        **{name: verdict[name] for name in TOLD},
        "diagnoses": shown,
        "diagnoses_left_out": len(verdict["diagnoses"]) - len(shown),
    }


def head_of(desk: Desk, do: str, asked: arguments.Searched, *, of_all: bool = False) -> Head:
    """The question for the process that judges; tasks, states and edits are checked there.

    Args:
        desk: Knows kitchens and robots.
        do: What is asked.
        asked: Arguments of the tool.
        of_all: Whether it is about every robot where none is named.
    """
    service = desk.service(asked.kitchen)
    is_open = of_all and asked.robot is None
    robot = None if is_open else service.twin.name(desk.robot(service, asked.robot))
    return asked.model_dump() | {"do": do, "kitchen": desk.kitchen_name(asked.kitchen), "robot": robot}


def _known(desk: Desk, verdict: str) -> Iri:
    """The kept verdict of this IRI, or whose hash begins like this."""
    stem = verdict_iri("")
    start = stem + verdict.removeprefix(stem).removeprefix("id:verdict/")
    found = [each for each in desk.kept if each.startswith(start)]
    if len(found) != 1:
        raise UnknownEntityError(
            "verdict",
            verdict,
            (each.removeprefix(stem) for each in _latest(desk.kept)),
            "verify_motion makes one",
        )
    return found[0]


def _latest(kept: Iterable[Iri]) -> list[Iri]:
    return list(kept)[-5:]


def headline(verdict: Json) -> str:
    """Outcome, and what it is about."""
    outcome = verdict["outcome"].replace("_", " ").upper()
    who = f"{verdict['robot']} in kitchen {verdict['kitchen']}"
    return f"{outcome} {verdict['task']}({verdict['container']}), {who}"


def reason_line(diagnosis: Json) -> str:
    """Kind, reason, and how sure it is."""
    text = f"{diagnosis['kind'].replace('_', ' ')}: {diagnosis['reason']}"
    search = diagnosis["search"]
    if diagnosis["proof"]:
        return f"{text} [proved]"
    if search is None:
        return text
    return f"{text} [{Search(**search)}, not proved]"


def _measured(evidence: dict[str, Any] | None) -> list[str]:  # JSON
    if evidence is None:
        return []
    line = evidence_line(evidence, "unknown")
    return [f"   {line}"] if line else []
