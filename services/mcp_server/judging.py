"""Tools that judge: verify a motion, ask what if, tell why in plain words."""

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
from services.whatif.answers import MOST_SHARES
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


async def what_if(desk: Desk, asked: arguments.WhatIf) -> Report:
    """The verdict as it is, the other one, and what differs; or at which share of the edits it turns."""
    searches = min(MOST_SHARES * asked.budget, 2 * arguments.MOST_BUDGET) if asked.turn else 2 * asked.budget
    reply = await desk.judge(head_of(desk, "what_if", asked), FIRST + searches)
    return _turn(desk, reply) if asked.turn else _contrast(desk, reply, asked.edits)


def _contrast(desk: Desk, reply: Json, edits: list[str]) -> Report:
    actual, other = reply["actual"], reply["counterfactual"]
    _note(desk, actual, other, edits)
    lines = (
        f"as it is: {_headline(actual)}",
        f"otherwise: {_headline(other)} ({'; '.join(edits)})",
        "the outcome turns" if reply["turned"] else "the outcome stays",
        *_differing(reply),
    )
    return Report(lines, {"turned": reply["turned"], **_differences(reply)}, "differences", MORE)


def _turn(desk: Desk, reply: Json) -> Report:
    """At which share, and at which none yet; or that none turns it, which is searched and not proved."""
    actual, other = reply["actual"], reply["counterfactual"]
    tried = [f"{100 * each['share']:.1f} %: {each['outcome']}" for each in reply["tried"]]
    data: Json = {name: reply[name] for name in ("found", "share", "edits", "not_yet", "tolerance")}
    if other is None:
        most = "; ".join(reply["tried"][-1]["edits"])
        lines = (f"as it is: {_headline(actual)}", f"no turn up to {most}: searched, not proved", *tried)
        return Report(lines, data | {"actual": _short(actual), "tried": reply["tried"]}, "tried", MORE)
    _note(desk, actual, other, reply["edits"])
    lines = (
        f"as it is: {_headline(actual)}",
        f"turns at: {'; '.join(reply['edits'])}: {_headline(other)}",
        f"not yet at: {'; '.join(reply['not_yet'])}",
        *_differing(reply),
        *tried,
    )
    return Report(lines, data | _differences(reply), "differences", MORE)


def _note(desk: Desk, actual: Json, other: Json, edits: list[str]) -> None:
    """By which edits the other verdict's world is another one, unless it was judged as one that is loaded."""
    desk.edited.pop(actual["iri"], None)
    if not other["stored"] and other["iri"] != actual["iri"]:
        desk.edited = {iri: of for iri, of in desk.edited.items() if iri in desk.kept}
        desk.edited[other["iri"]] = tuple(edits)


def _differing(reply: Json) -> list[str]:
    """What differs between two verdicts, and which they are."""
    predicates = [
        f"  {each['predicate']}: {WORDS[each['actual']]}, otherwise {WORDS[each['counterfactual']]}"
        for each in reply["predicates"]
    ]
    return [
        *predicates,
        *(f"  no longer: {_reason(each)}" for each in reply["no_longer"]),
        *(f"  now: {_reason(each)}" for each in reply["now"]),
        f"verdict as it is: {reply['actual']['iri']}",
        f"verdict otherwise: {reply['counterfactual']['iri']}",
    ]


def _differences(reply: Json) -> Json:
    """The same as data."""
    return {
        "predicates": reply["predicates"],
        "actual": _short(reply["actual"]),
        "counterfactual": _short(reply["counterfactual"]),
        "differences": [
            {"where": where, **each}
            for where, key in (("no longer", "no_longer"), ("now", "now"))
            for each in reply[key]
        ],
    }


def _short(verdict: Json) -> Json:
    return {"outcome": verdict["outcome"], "iri": verdict["iri"]}


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
        for line in (f"{number}. {_reason(each)}", *_measured(each["evidence"]))
    ]
    again = ["Judged before in this session; the answer is the same."] if verdict["stored"] else []
    return [
        _headline(verdict),
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


def head_of(desk: Desk, do: str, asked: arguments.Searched) -> Head:
    """The question for the process that judges; tasks, states and edits are checked there."""
    service = desk.service(asked.kitchen)
    robot = service.twin.name(desk.robot(service, asked.robot))
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


def _headline(verdict: Json) -> str:
    outcome = verdict["outcome"].replace("_", " ").upper()
    who = f"{verdict['robot']} in kitchen {verdict['kitchen']}"
    return f"{outcome} {verdict['task']}({verdict['container']}), {who}"


def _reason(diagnosis: Json) -> str:
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
