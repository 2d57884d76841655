"""Φ stops a container where it meets another body of the kitchen."""

import math
from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from predicates.case import Diagnosis, Evidence, Kind, Quantity
from predicates.oracle import Replayed
from sdt_kg.iri import Iri, local_name
from sdt_kg.numbers import told_apart
from sdt_kg.twin import Twin
from services.physics.chain import follower
from services.physics.replay import BEYOND_STOPS, effective_bounds, spline_of, state_with
from services.physics.stops.block import Block
from services.physics.stops.sweep import Sweep
from services.physics.tree import Model


def stopped(sweep: Sweep, model: Model, twin: Twin, replayed: Replayed) -> Replayed:
    """The replay as it is, or stopped where the motion runs into the rest of the kitchen.

    The shapes are outer shapes and have an allowance, so a stop is no proof.
    """
    motion = replayed.motion
    followed = follower(model, motion.of)
    bounds = effective_bounds(model, twin, followed)
    times, values = spline_of(motion).position()
    active = (values - followed.offset) / followed.multiplier
    began = twin.state.get(followed.active, 0.0)
    stops, passed = list[tuple[float, Block]](), list[Block]()
    for limit in (bounds.lower, bounds.upper):
        toward = (limit - followed.offset) / followed.multiplier
        sign = np.sign(toward - began)
        past = (active - began) * sign
        if past.max() <= BEYOND_STOPS:
            continue
        end = toward if math.isfinite(toward) else float(active[np.argmax(past)])
        block = sweep.first_block(twin.state, followed.active, end)
        if block is not None and past.max() >= abs(block.position - began):
            stops.append((float(times[np.argmax(past >= abs(block.position - began))]), block))
        passed += sweep.passed(twin.state, followed.active, end)
    replayed = replace(replayed, notes=(*replayed.notes, *_drawn_so(passed)))
    if not stops:
        return replayed
    time, block = min(stops, key=lambda stop: stop[0])
    final = state_with(model, twin, followed.active, block.position)
    violations = (*replayed.violations, _violation(block, time))
    return replace(replayed, final=final, violations=violations)


def _drawn_so(passed: list[Block]) -> Iterator[str]:
    """What goes through what, once for each two bodies, where they are deepest."""
    deepest: dict[tuple[Iri, Iri], Block] = {}
    for one in sorted(passed, key=lambda one: one.depth):
        deepest[one.moved, one.other] = one
    for one in deepest.values():
        depth, drawn, allowed = (f"{1e3 * each:.1f} mm" for each in (one.depth, one.drawn, one.allowed))
        moved, other = local_name(one.moved), local_name(one.other)
        why = f"the model has them {drawn} in each other, so {allowed} are allowed"
        yield f"{moved} goes {depth} deep in {other}: {why}"


def _violation(block: Block, time: float) -> Diagnosis:
    moved, other = local_name(block.moved), local_name(block.other)
    depth, allowed = told_apart(1e3 * block.depth, 1e3 * block.allowed, 1, "f")
    how = f"{depth} mm deep at {time:.3f} s, {allowed} mm allowed"
    if block.drawn:
        how += f", as the model has them {1e3 * block.drawn:.1f} mm in each other"
    if block.allowed < 0:
        how = f"at {time:.3f} s; two meshes that are not convex may not touch"
    reason = f"{moved} runs into {other}: {how}"
    evidence = Evidence(
        Quantity.DISTANCE,
        -block.depth,
        -block.allowed,
        "m",
        entity=block.moved,
        links=(block.moved, block.other),
        time=time,
        scope="environment",
    )
    return Diagnosis(Kind.CAUSAL, reason, evidence)
