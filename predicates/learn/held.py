"""A container that was seen to be held: its joint says so, since no force data have it."""

from dataclasses import replace

import numpy as np

from predicates.learn.frames import rejoined
from predicates.learn.phases import Latch, PushToOpen
from sdt_kg.iri import local_name
from sdt_kg.mechanism import LEARNED
from sdt_kg.twin import Container, Twin

UNJUDGED = "no verdict counts with it: D_artic has no forces, D_artic_dyn those of force data (--forces)"


def held(twin: Twin, container: Container, phase: Latch | PushToOpen) -> Twin:
    """The twin whose joint notes what held the container, for verdicts to tell."""
    kitchen = twin.mechanism(twin.environment)
    joint = kitchen.joint(local_name(container.joint))
    after = replace(joint, notes=(*joint.notes, f"{LEARNED} to be held by {_what(phase)}; {UNJUDGED}"))
    return rejoined(twin, after, np.eye(4), f"learned: what holds {container.name}")


def _what(phase: Latch | PushToOpen) -> str:
    if isinstance(phase, Latch):
        return f"a latch that gives way at {phase.force:.1f} ± {phase.force_deviation:.1f} N"
    return f"a push-to-open, pushed in {phase.depth * 1000:.1f} mm with {phase.force:.1f} N"
