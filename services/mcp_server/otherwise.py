"""The tool that asks what if: in another world, at which share of a change, in a grid, by which change."""

from typing import Final

from predicates.record.report import WORDS
from services.mcp_server import arguments
from services.mcp_server.desk import FIRST, Desk
from services.mcp_server.judging import MORE, head_of, headline, reason_line, telling
from services.mcp_server.report import Json, Report, size
from services.policy import DEFAULT_WITHIN
from services.whatif.answers import MOST_SHARES

MOST_REASONS: Final = 3
"""Of one verdict in a report about several."""
MOST_COUNTED: Final = 1500
"""[characters] Of the worlds of a grid in its data."""
NAMED: Final = "'what_if' about one container with one of these edits tells what differs"


async def what_if(desk: Desk, asked: arguments.WhatIf) -> Report:
    """The verdict as it is, the other one, and what differs; or where it turns; or a grid of worlds."""
    head = head_of(desk, "what_if", asked, of_all=asked.grid)
    reply = await desk.judge(head, FIRST + _seconds(asked))
    if asked.grid:
        return _grid(reply)
    if not asked.edits:
        return _smallest(reply)
    return _turn(desk, reply) if asked.turn else _contrast(desk, reply, asked.edits)


def _seconds(asked: arguments.WhatIf) -> float:
    """Of search at most [s]; a grid is not counted before it is judged."""
    most = 2 * arguments.MOST_BUDGET
    if asked.grid:
        return most
    if not asked.edits:
        return 2 * (asked.within or DEFAULT_WITHIN)  # seconds of CPU, which others take too
    return min(MOST_SHARES * asked.budget, most) if asked.turn else 2 * asked.budget


def _contrast(desk: Desk, reply: Json, edits: list[str]) -> Report:
    actual, other = reply["actual"], reply["counterfactual"]
    _note(desk, actual, other, edits)
    lines = (
        f"as it is: {headline(actual)}",
        f"otherwise: {headline(other)} ({'; '.join(edits)})",
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
        lines = (f"as it is: {headline(actual)}", f"no turn up to {most}: searched, not proved", *tried)
        return Report(lines, data | {"actual": _short(actual), "tried": reply["tried"]}, "tried", MORE)
    _note(desk, actual, other, reply["edits"])
    lines = (
        f"as it is: {headline(actual)}",
        f"turns at: {'; '.join(reply['edits'])}: {headline(other)}",
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
        *(f"  no longer: {reason_line(each)}" for each in reply["no_longer"]),
        *(f"  now: {reason_line(each)}" for each in reply["now"]),
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


def _smallest(reply: Json) -> Report:
    """The smallest change of each kind, those that turn the outcome first, and how sure that is."""
    actual = reply["actual"]
    told = sorted(reply["families"], key=lambda each: not each["found"])
    lines = [
        f"as it is: {actual['outcome'].replace('_', ' ').upper()} {reply['task']}, "
        f"{reply['robot']} in kitchen {reply['kitchen']}",
        *(f"  {reason_line(each)}" for each in telling(actual["diagnoses"])[:MOST_REASONS]),
        *(line for each in told for line in _of_kind(each)),
        f"verdict as it is: {actual['iri']}",
    ]
    names = ("family", "found", "edit", "not_yet", "sure")
    families = [
        {name: each[name] for name in names}
        | {"outcome": each["verdict"] and each["verdict"]["outcome"], "tried": len(each["tried"])}
        for each in told
    ]
    return Report(tuple(lines), {"actual": _short(actual), "families": families}, "families", NAMED)


def _of_kind(one: Json) -> list[str]:
    if not one["found"]:
        return [f"{one['family']}? none found ({one['sure']}); looked at: {one['range']}"]
    smaller = "" if one["not_yet"] is None else f"; not yet at {one['not_yet']}"
    now = [f"  now: {reason_line(each)}" for each in one["differs"]["now"][:MOST_REASONS]]
    return [f"{one['family']}? {one['edit']}: {one['verdict']['outcome']} ({one['sure']}){smaller}", *now]


def _grid(reply: Json) -> Report:
    """How many are certified in each world, and what turns there, and why."""
    worlds = [
        f"{row['world']}: " + "; ".join(f"{name} {row[name]}" for name in row if name != "world")
        for row in reply["worlds"]
    ]
    turns = [
        f"{each['world']}: {each['robot']} {each['container']}: {each['outcome']}: {each['why']}"
        for each in reply["turned"]
    ]
    data: Json = {"cases": len(reply["cells"]), "turned": reply["turned"], "worlds": list[Json]()}
    for row in reply["worlds"]:
        if size(data["worlds"]) + size(row) > MOST_COUNTED:
            break
        data["worlds"].append(row)
    data["worlds_left_out"] = len(worlds) - len(data["worlds"])
    lines = ("certified of judged:", *worlds, "what turns:" if turns else "nothing turns", *turns)
    return Report(lines, data, "turned", NAMED)
