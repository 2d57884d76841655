"""Results of task specifications: the list of them, and one with its steps and rules."""

import asyncio
from typing import Final

import pyoxigraph as ox
from starlette.requests import Request

from predicates.case import Outcome
from predicates.record.facts import Facts
from predicates.record.stored import read_diagnosis, read_inputs
from sdt_kg.iri import ID, LAW, RDFS, Iri, local_name
from services.http.api.read import SPELLED, of_models
from services.http.pages.kinds import Standing, standings
from services.http.pages.stored import rows
from services.http.pages.terms import id_link
from services.http.pages.verdicts.one import or_damaged, rechecks
from services.http.pages.view import Json, View
from services.http.world import World
from services.versions import outdated
from services.why import sections, task

LISTED: Final = (
    "kitchen",
    "task",
    "robot",
    "outcome",
    "outdated",
    "about_served",
    "kinds",
    "steps",
    "rules",
    "seconds",
    "kitchen_hash",
    "robot_hash",
    "result",
)
PARTS: Final = ("part", "number", "what", "outcome", "how", "step", "time", "verdict")
TOLD: Final = ("Asked", "Reasons", "Quality", "Versions and inputs", "To check again")
"""Parts of the story that are shown as they are told on the shell."""


async def results(request: Request) -> View:
    """Every result that is kept, by kitchen, task and robot."""
    world: World = request.app.state.world
    found = await rows(world, "task_results")
    listed = await asyncio.to_thread(lambda: [_listed(world, each) for each in found])
    return View("tasks", {"results": listed}, listed, LISTED)


def _listed(world: World, row: dict[str, str]) -> Json:
    return {
        "kitchen": local_name(row["environment"]),
        "task": row["label"],
        "robot": local_name(row["robot"]),
        "outcome": SPELLED[local_name(row["outcome"])],
        "outdated": bool(outdated(row)),
        "kinds": [each.value.key for each in standings(local_name(row["outcome"]), row.get("kinds", ""))],
        "steps": int(row["steps"]),
        "rules": int(row["rules"]),
        "seconds": round(float(row["seconds"]), 3),
        "result": row["result"],
        "link": id_link(row["result"]),
    } | of_models(world, row)


def result(request: Request, iri: Iri, quads: list[ox.Quad]) -> View:
    """The page of a result, whose graph these quads are; a damaged record says so and claims nothing."""
    return or_damaged(lambda: _read(request, iri, quads), iri, PARTS)


def _read(request: Request, iri: Iri, quads: list[ox.Quad]) -> View:
    facts = Facts(quads)
    first, *others = sections(quads, iri)
    told = {each.title: list(each.lines) for each in others}
    outcome, others = task.outcome_of(iri, facts), outdated(dict(read_inputs(facts, iri)))
    diagnoses = [read_diagnosis(facts, each) for each in facts.all(iri, LAW + "diagnosis")]
    kinds = [] if outcome is Outcome.CERTIFIED else list(dict.fromkeys(each.kind.value for each in diagnoses))
    steps = [_step(each, facts) for each in facts.all(iri, LAW + "stepResult")]
    rules = [_rule(number, each, facts) for number, each in enumerate(facts.all(iri, LAW + "ruleAnswer"), 1)]
    data: Json = {
        "iri": iri,
        "name": local_name(iri),
        "question": task.question(iri, facts),
        "outcome": outcome.value,
        "outdated": list(others),
        "kinds": kinds,
        "means": " ".join(first.lines),
        "kitchen": local_name(facts.needed(iri, LAW + "environment")),
        "robot": local_name(facts.needed(iri, LAW + "robot")),
        "seconds": facts.measured(iri, LAW + "seconds"),
        "steps": steps,
        "rules": rules,
        "why": told,
        "recheck": rechecks(request).known(iri, quads),
    }
    usual = Standing.CERTIFIED if outcome is Outcome.CERTIFIED else Standing.NO_VERDICT
    shown: Json = {
        "standing_key": Standing.OUTDATED.value.key if others else (kinds or [usual.value.key])[0],
        "told": {name: told.get(name, []) for name in TOLD},
        "path": "/id/" + iri.removeprefix(ID),
        "graph": "/id/graph/task_result/" + local_name(iri),
        "is_whole": facts.text(iri, LAW + "writtenAs") is not None,
    }
    return View("task", data, [*steps, *rules], PARTS, shown)


def _step(of: Iri, facts: Facts) -> Json:
    asked = facts.needed(of, LAW + "task")
    verdict = facts.needed(of, LAW + "verdict")
    return {
        "part": "step",
        "number": int(facts.measured(asked, LAW + "index")),
        "what": task.request(asked, facts),
        "outcome": task.outcome_of(of, facts).value,
        "verdict": verdict,
        "link": id_link(verdict),
    }


def _rule(number: int, of: Iri, facts: Facts) -> Json:
    step = facts.text(of, LAW + "inStep")
    return {
        "part": "rule",
        "number": number,
        "what": facts.needed(of, RDFS + "label"),
        "outcome": task.STANDING[local_name(facts.needed(of, LAW + "standing"))].lower(),
        "how": facts.needed(of, LAW + "checkedHow"),
        "step": None if step is None else int(local_name(step)),
        "time": facts.number(of, LAW + "time"),
    }
