"""Inertias as files have them: what no body can have is left out, and a note says so."""

from collections.abc import Iterable
from dataclasses import replace

from sdt_kg.mechanism import Body


def with_possible(bodies: Iterable[Body]) -> tuple[tuple[Body, ...], tuple[str, ...]]:
    """The bodies, without inertias that no body can have, and a note of each of these.

    Such figures stand in files of real robots. Kinematics does without them; forces of what has no
    inertia are not checked, and a verdict says so.
    """
    kept, notes = list[Body](), list[str]()
    for body in bodies:
        if body.inertia is None or body.inertia.possible:
            kept.append(body)
            continue
        kept.append(replace(body, inertia=None))
        moments = ", ".join(f"{each:g}" for each in body.inertia.moments)
        notes.append(
            f"the inertia of {body.name} is left out, with its mass of {body.inertia.mass:g} kg: "
            f"no body has these moments, ixx to izz {moments} kg m²"
        )
    return tuple(kept), tuple(notes)
