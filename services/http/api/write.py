"""Verbs that compute or write, each into its own graph.

causes, achieve, task, place, whatif, query; state, observation, branch.
"""

import asyncio
import hashlib
import json
from itertools import chain
from typing import Final, TypeVar

import pyoxigraph as ox
from fastapi import APIRouter, Depends, FastAPI, Request

from predicates.record.inputs import UNKNOWN_INPUT
from sdt_kg.errors import InputError, UnknownEntityError
from sdt_kg.history import Edit, changed, moved
from sdt_kg.iri import DCTERMS, ID, RDF, SDT, XSD, Iri, graph_iri, local_name, part_iri
from sdt_kg.twin import Twin
from services.compute.besides import BESIDES, besides
from services.http.api.models import (
    AchieveBody,
    BranchBody,
    CausesBody,
    ObservationBody,
    PlaceBody,
    QueryBody,
    StateBody,
    Stated,
    TaskBody,
    WhatIfBody,
)
from services.http.api.read import Json, state_json, world_of
from services.http.judges import Judges, question
from services.http.protocol.exchange import check_body, check_parameters
from services.http.world import World
from services.judging.messages import REQUESTS, ComputeRequest, Verb
from services.judging.replies import (
    CausesReply,
    ComputeReply,
    PlaceReply,
    Reply,
    TaskReply,
    VerdictsReply,
    WhatIfReply,
)
from services.requests import parse_state
from services.store.workers import Asked

R = TypeVar("R", bound=Reply)

SOSA: Final = "http://www.w3.org/ns/sosa/"

GRACE: Final = 120.0
"""[s] Beyond its budget, for loading and for the case that has begun."""

router = APIRouter(prefix="/api/v1", dependencies=[Depends(check_parameters), Depends(check_body)])


@router.post("/causes")
async def causes(request: Request, body: CausesBody) -> list[Json]:
    """Motions that would cause the task, or whether the given one does; no robot, nothing is written.

    The objects of `sdt causes --json`, each with its motion as arrays.
    """
    found = await _asked(request.app, Verb.CAUSES, body, CausesReply)
    each = zip(found.answers, found.holds, found.motions, strict=True)
    return [answer | {"holds": holds, "motion": motion} for answer, holds, motion in each]


@router.post("/achieve")
async def achieve(request: Request, body: AchieveBody) -> Json:
    """CanAchieve: one verdict for each robot and container that is meant, judged here and kept.

    This is the only way in which a verdict gets into the graph: what somebody else judged is not taken.
    """
    return await judged(request.app, body)


async def judged(app: FastAPI, body: AchieveBody) -> Json:
    """The verdicts, which are kept by then."""
    reply = await _asked(app, Verb.CANACHIEVE, body, VerdictsReply)
    found: Json = {"verdicts": reply.verdicts}
    return found | {"motions": reply.motions} if body.motions else found


@router.post("/task")
async def task(request: Request, body: TaskBody) -> Json:
    """What becomes of a task's steps and rules; the result and the verdict of each step are kept."""
    return (await _asked(request.app, Verb.TASK, body, TaskReply)).result


@router.post("/place")
async def place(request: Request, body: PlaceBody) -> Json:
    """Certified base poses, and the map of what is known of others: as `sdt place --json`."""
    return (await _asked(request.app, Verb.PLACE, body, PlaceReply)).placement


@router.post("/whatif")
async def whatif(request: Request, body: WhatIfBody) -> Json:
    """The same question in another world, or in a grid of them, and what turns: as `sdt whatif --json`.

    Verdicts as things are are kept; those in other worlds are answered and not kept.
    """
    return (await _asked(request.app, Verb.WHATIF, body, WhatIfReply)).answer


async def _asked(app: FastAPI, verb: Verb, body: Stated, kind: type[R]) -> R:
    """What a process answers to the question, about the kitchen in its present state."""
    world: World = app.state.world
    judges: Judges = app.state.judges
    kitchen = world.kitchen(body.kitchen)
    asked = REQUESTS[verb](**body.model_dump(exclude={"kitchen", "seconds"}))
    return await judges.ask(question(verb, kitchen.name, asked, body.seconds, kitchen.moved), kind)


@router.post("/query")
async def query(request: Request, body: QueryBody) -> Json:
    """What the query can touch and nobody has judged is judged first, within bounds; then it is evaluated.

    The answer says what was judged and what was left out.
    """
    world = world_of(request)
    asked = Asked("query", body.query, accepted=("application/sparql-results+json", "application/n-triples"))
    await world.workers.ask(asked)  # what is refused is refused before anything is judged
    moved_ones = [each.name for each in world.kitchens.values() if each.present is not None]
    if moved_ones and len(world.kitchens) > 1:
        raise InputError(
            f"the state of {', '.join(moved_ones)} was moved, and several kitchens are served",
            allowed="one kitchen, or all as they were loaded",
            remedy="POST /api/v1/achieve about one case at a time",
        )
    states = tuple(text for name in moved_ones for text in world.kitchens[name].moved)
    wanted = ComputeRequest(**body.model_dump())
    judges: Judges = request.app.state.judges
    reply = await judges.ask(question(Verb.COMPUTE, "", wanted, body.budget + GRACE, states), ComputeReply)
    answered = await world.workers.ask(asked)
    results = json.loads(answered.body) if "json" in answered.media else answered.body.decode()
    return {"computed": reply.computed | {"besides": await _besides(world)}, "results": results}


async def _besides(world: World) -> dict[str, int]:
    """How many verdicts a query that names no input counts too, and that answer nothing that is asked now."""
    answered = await world.workers.ask(Asked("query", BESIDES, accepted=("application/sparql-results+json",)))
    rows = json.loads(answered.body)["results"]["bindings"]
    kitchens = list(world.kitchens.values())
    pairs = await asyncio.to_thread(lambda: list(chain.from_iterable(each.models for each in kitchens)))
    models = frozenset(chain.from_iterable(pairs))
    kept = [{name: term["value"] for name, term in row.items()} for row in rows]
    return dict(besides(kept, models - {UNKNOWN_INPUT}))


@router.post("/state")
async def state(request: Request, body: StateBody) -> Json:
    """Joints are elsewhere now. The state before stays, in its own graph and as a branch of the past."""
    kitchen = await world_of(request).move(body.kitchen, tuple(body.state))
    return state_json(kitchen)


@router.post("/observation", status_code=201)
async def observation(request: Request, body: ObservationBody) -> Json:
    """Keep what somebody observed, as SOSA observations in a graph of their own; it changes no state."""
    world = world_of(request)
    twin = world.kitchen(body.kitchen).twin
    if body.time.tzinfo is None:
        raise InputError(f"the time {body.time.isoformat()} has no zone", allowed="2026-01-31T12:00:00Z")
    joints = {local_name(joint): joint for joint in twin.state}
    for name in body.positions:
        if name not in joints:
            raise UnknownEntityError("joint", name, joints)
    positions = {joints[name]: at for name, at in body.positions.items()}
    text = f"{twin.environment} {body.time.isoformat()} {body.by} {sorted(positions.items())}"
    key = hashlib.sha256(text.encode()).hexdigest()
    graph = graph_iri("observed", key)
    whole = f"{ID}observation/{key}"
    await world.write(graph, observed_triples(whole, positions, body.time.isoformat(), body.by))
    return {"graph": graph, "observations": len(positions)}


def observed_triples(whole: Iri, positions: dict[Iri, float], time: str, by: str) -> list[ox.Triple]:
    """Where joints [rad or m] were seen, when (xsd:dateTime) and by whom, as SOSA observations."""
    moment = ox.Literal(time, datatype=ox.NamedNode(XSD + "dateTime"))
    triples: list[ox.Triple] = []
    for index, (joint, position) in enumerate(sorted(positions.items()), 1):
        node = ox.NamedNode(part_iri(whole, "joint", index))
        for predicate, value in (
            (RDF + "type", ox.NamedNode(SOSA + "Observation")),
            (SOSA + "hasFeatureOfInterest", ox.NamedNode(joint)),
            (SOSA + "observedProperty", ox.NamedNode(SDT + "position")),
            (SOSA + "hasSimpleResult", ox.Literal(position)),
            (SOSA + "resultTime", moment),
            (DCTERMS + "creator", ox.Literal(by)),
        ):
            triples.append(ox.Triple(node, ox.NamedNode(predicate), value))
    return triples


@router.post("/branch", status_code=201)
async def branch(request: Request, body: BranchBody) -> Json:
    """What if: a branch of the present or of another branch; asking it by its graphs changes nothing."""
    if bool(body.state) == (body.edit is not None):
        raise InputError("a branch needs a state or an edit", allowed="one of them")
    made = await world_of(request).branch(body.kitchen, lambda twin: _edit(twin, body), body.parent)
    return {
        "iri": made.iri,
        "parent": made.parent.iri if made.parent else None,
        "graph": graph_iri("branch", local_name(made.iri)),
        "state_graph": made.twin.graphs()[-1],
        "content_hash": made.content_hash,
        "events": [event.type.value for event in made.events],
    }


def _edit(twin: Twin, body: BranchBody) -> Edit:
    if body.edit is not None:
        return changed(twin, body.edit.entity, **body.edit.changes)
    positions = parse_state(twin, body.state)
    return moved({joint: at for joint, at in positions.items() if at != twin.state[joint]})
