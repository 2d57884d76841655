"""Verbs that read: kitchens, containers, satisfies, verdicts, why, state, branches and their differences."""

import asyncio
import json
import math
from collections.abc import Mapping
from dataclasses import asdict
from typing import Annotated, Any

import pyoxigraph as ox
from fastapi import APIRouter, Depends, Query, Request

from predicates.record.inputs import UNKNOWN_INPUT
from sdt_kg.errors import UnknownEntityError
from sdt_kg.history.diff import twin_difference
from sdt_kg.iri import Iri, local_name, verdict_iri
from sdt_kg.task import Task
from services.http.kitchens import Kitchen
from services.http.problems import RefusedError
from services.http.protocol.exchange import check_parameters
from services.http.world import World
from services.store.workers import Asked
from services.versions import ORACLES, outdated
from services.why import Section, named, sections, text

VERDICTS = """SELECT ?verdict ?kitchen ?robot ?container ?task ?outcome ?seconds ?physics ?embodiment
  ?environment_model ?robot_model WHERE {
  ?verdict a law:Verdict ; law:environment ?kitchen ; law:outcome ?outcome ; law:seconds ?seconds .
  OPTIONAL { ?verdict law:robot ?robot }
  OPTIONAL { ?verdict law:container ?container }
  OPTIONAL { ?verdict law:task ?asked . ?asked law:verb ?task }
  OPTIONAL { ?verdict prov:wasGeneratedBy/prov:used ?phi . ?phi law:name "physics" ; law:inputHash ?physics }
  OPTIONAL {
    ?verdict prov:wasGeneratedBy/prov:used ?r . ?r law:name "embodiment" ; law:inputHash ?embodiment
  }
  OPTIONAL {
    ?verdict prov:wasGeneratedBy/prov:used ?e . ?e law:name "environment" ; law:inputHash ?environment_model
  }
  OPTIONAL {
    ?verdict prov:wasGeneratedBy/prov:used ?m . ?m law:name "robot" ; law:inputHash ?robot_model
  }
}
ORDER BY ?verdict"""
OUTCOMES = {"certified": "Certified", "not_certified": "NotCertified", "abstained": "Abstained"}
"""As JSON spells an outcome → as the graph does."""
SPELLED = {term: name for name, term in OUTCOMES.items()}

router = APIRouter(prefix="/api/v1", dependencies=[Depends(check_parameters)])
Json = dict[str, Any]  # JSON object
KitchenName = Annotated[str | None, Query(description="may be left out where one kitchen is served")]
States = Annotated[list[str], Query(description="JOINT=VALUE, on top of the present state; repeatable")]


def world_of(request: Request) -> World:
    """What is served."""
    return request.app.state.world


@router.get("/kitchens")
async def kitchens(request: Request) -> list[Json]:
    """The kitchens that are served, with their robots."""
    return [
        {
            "name": kitchen.name,
            "iri": kitchen.twin.environment,
            "robots": [local_name(robot) for robot in kitchen.twin.robots],
            "containers": len(kitchen.twin.containers()),
            "notes": list(kitchen.twin.notes),
        }
        for kitchen in world_of(request).kitchens.values()
    ]


@router.get("/containers")
async def containers(request: Request, kitchen: KitchenName = None, *, left_out: bool = False) -> Json:
    """The counted containers, with joints, handles and limits; with `left_out` also what is not counted."""
    twin = world_of(request).kitchen(kitchen).twin
    found: Json = {
        "containers": [
            {name: finite(value) for name, value in asdict(each).items()} for each in twin.containers()
        ]
    }
    if left_out:
        found["left_out"] = [asdict(each) for each in await asyncio.to_thread(twin.left_out)]
    return found


@router.get("/satisfies")
async def satisfies(
    request: Request,
    kitchen: KitchenName = None,
    state: States = [],  # noqa: B006 - FastAPI copies it
) -> list[Json]:
    """The requests which the present state meets, or that state: SatisfiesRequest, backwards."""
    service = world_of(request).kitchen(kitchen).service
    answers = await asyncio.to_thread(lambda: list(service.at(*state).satisfies()))
    tasks = (answer.case.task for answer in answers)
    return [
        {"task": task.verb.value, "container": local_name(task.container)}
        for task in tasks
        if isinstance(task, Task) and isinstance(task.container, str)
    ]


@router.get("/state")
async def state(request: Request, kitchen: KitchenName = None) -> Json:
    """Where the joints are now [rad or m], and the graph that says so."""
    return state_json(world_of(request).kitchen(kitchen))


@router.get("/branches")
async def branches(request: Request, kitchen: KitchenName = None) -> list[Json]:
    """Branches of a kitchen, the first one first; none before something was written."""
    history = world_of(request).kitchen(kitchen).history
    if history is None:
        return []
    return [
        {
            "iri": each.iri,
            "parent": each.parent.iri if each.parent else None,
            "edit": each.edit.sentence if each.edit else None,
            "content_hash": each.content_hash,
            "events": [event.type.value for event in each.events],
        }
        for each in history.branches.values()
    ]


@router.get("/diff")
async def diff(request: Request, before: str, after: str, kitchen: KitchenName = None) -> Json:
    """How one branch differs from another one, entities and state, in sentences."""
    history = world_of(request).kitchen(kitchen).history
    if history is None:
        raise UnknownEntityError("branch", before, (), "POST /api/v1/state or /api/v1/branch makes one")
    twins = [history.branch(iri).twin for iri in (before, after)]
    found = await asyncio.to_thread(twin_difference, *twins)
    return {
        "before": before,
        "after": after,
        "sentences": found.sentences(),
        "removed": len(found.removed),
        "added": len(found.added),
    }


@router.get("/verdicts")
async def verdicts(
    request: Request,
    kitchen: str | None = None,
    robot: str | None = None,
    container: str | None = None,
    outcome: str | None = None,
) -> list[Json]:
    """Verdicts that are kept; names of a robot, kitchen, container or outcome select.

    A name is one of what is served, or of what a verdict is about. `outdated`: another version judged.
    `about_served`: its kitchen and robot are served as they were then.
    """
    if outcome is not None and outcome not in OUTCOMES:
        raise UnknownEntityError("outcome", outcome, OUTCOMES)
    wanted = {"kitchen": kitchen, "robot": robot, "container": container, "outcome": outcome}
    rows, served = await _rows(world_of(request)), world_of(request).names()
    for name in ("kitchen", "robot", "container"):
        known = served[name] | {row[name] for row in rows if row[name] is not None}
        if wanted[name] not in {None, *known}:
            raise UnknownEntityError(name, str(wanted[name]), known)
    return [row for row in rows if _fits(row, wanted)]


@router.get("/verdicts/{key}")
async def verdict(request: Request, key: str) -> Json:
    """One verdict, by its hash or the beginning of it; its triples are the graph `/id/graph/verdict/KEY`."""
    iri = verdict_iri(key)
    found = [row for row in await _rows(world_of(request)) if row["iri"].startswith(iri)]
    if len(found) > 1:
        raise UnknownEntityError("verdict", key, [local_name(row["iri"]) for row in found])
    if not found:
        raise _no_verdict(iri)
    (row,) = found
    return row | {"why": text((await _told(world_of(request), row["iri"]))[1])}


@router.get("/why")
async def why_verdict(request: Request, iri: str) -> Json:
    """A verdict in plain words: what was asked, each answer, the reasons, how to check it again.

    `iri` may be the beginning of the verdict's hash, or that of the result of a task.
    """
    told, story = await _told(world_of(request), iri)
    parts = [{"title": each.title, "lines": list(each.lines)} for each in story]
    return {"iri": told, "text": text(story), "sections": parts}


async def _told(world: World, iri: Iri) -> tuple[Iri, tuple[Section, ...]]:
    """The whole IRI of a verdict, and the verdict in plain words, part by part."""
    quads = await world.told(iri)
    if not quads:
        raise _no_verdict(iri)
    store = ox.Store()
    store.load(quads, format=ox.RdfFormat.N_QUADS)
    whole = named(store, iri)
    return whole, await asyncio.to_thread(sections, store, whole)


def _no_verdict(iri: str) -> RefusedError:
    """What is said of an IRI that is none of the thousands that may be kept."""
    return RefusedError(
        404,
        f"no verdict <{iri[:200]}> is kept here",
        allowed="the IRI of one that is, or the beginning of its hash",
        remedy="GET /api/v1/verdicts lists them",
    )


async def _rows(world: World) -> list[Json]:
    media = "application/sparql-results+json"
    answered = await world.workers.ask(Asked("query", VERDICTS, accepted=(media,)))
    bindings = json.loads(answered.body)["results"]["bindings"]
    return await asyncio.to_thread(lambda: [_row(world, each) for each in bindings])


def _fits(row: Json, wanted: dict[str, str | None]) -> bool:
    return all(value is None or row[name] == value for name, value in wanted.items())


def state_json(kitchen: Kitchen) -> Json:
    """A kitchen's present state."""
    return {
        "kitchen": kitchen.name,
        "graph": kitchen.state_graph,
        "branch": kitchen.present.iri if kitchen.present else None,
        "positions": {local_name(joint): at for joint, at in kitchen.twin.state.items()},
    }


def _row(world: World, binding: Json) -> Json:
    names = ("kitchen", "robot", "container", "task")
    row: Json = {name: local_name(binding[name]["value"]) if name in binding else None for name in names}
    row["task"] = row["task"].lower() if row["task"] else None
    row["outcome"] = SPELLED[local_name(binding["outcome"]["value"])]
    row["outdated"] = bool(outdated({name: binding[name]["value"] for name in ORACLES if name in binding}))
    row |= of_models(world, {name: term["value"] for name, term in binding.items()})
    return row | {"seconds": float(binding["seconds"]["value"]), "iri": binding["verdict"]["value"]}


def of_models(world: World, row: Mapping[str, str]) -> Json:
    """Hashes of the models that a verdict is about, and whether these are the ones that are served now.

    Args:
        world: What is served.
        row: With `environment_model` and `robot_model`, inputs of the verdict, where bound.
    """
    environment, robot = row.get("environment_model", ""), row.get("robot_model", UNKNOWN_INPUT)
    return {
        "kitchen_hash": environment.partition(" ")[2] or None,
        "robot_hash": robot.partition(" ")[2] or None,
        "about_served": world.serves(environment, robot),
    }


def finite(value: object) -> object:
    """JSON has no infinity: a limit that is not there is null."""
    return None if isinstance(value, float) and not math.isfinite(value) else value
