"""Joints that move together, as triples about one of them: derived, and in no graph of a twin."""

from collections.abc import Iterator

import pyoxigraph as ox

from sdt_kg.entities.coupling import Coupling
from sdt_kg.iri import SDT, Iri, joint_iri
from sdt_kg.mechanism import Mechanism
from sdt_kg.store import Triple

MOVES_WITH, HANGS_ON = SDT + "movesWith", SDT + "hangsOn"


def moving_together(mechanism: Mechanism, joint: Iri) -> Iterator[Triple]:
    """Which joints move with this one, and which of all these hang on another of them."""
    others = Coupling.of(mechanism).together(joint)
    if not others:
        return
    above = {each.child: each for each in mechanism.joints}
    together = {joint, *others}
    for other in sorted(others):
        yield joint, MOVES_WITH, ox.NamedNode(other)
    for each in mechanism.joints:
        one, body = joint_iri(mechanism.name, each.name), each.parent
        while one in together and body in above:
            upper = joint_iri(mechanism.name, above[body].name)
            if upper in together:
                yield one, HANGS_ON, ox.NamedNode(upper)
            body = above[body].parent
