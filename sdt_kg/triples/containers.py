"""Containers that a graph or annotation states itself: what is held is moved by the joint that is named."""

from collections.abc import Iterable

from sdt_kg.iri import SDT, body_iri, local_name
from sdt_kg.mechanism import Mechanism
from sdt_kg.store import Triple, value_of

_HANDLE, _JOINT = SDT + "hasHandle", SDT + "hasJoint"


def torn(triples: Iterable[Triple], mechanism: Mechanism) -> str:
    """What a container is said to have that does not move with it, in words; empty if all does.

    A hand that held a post beside a door would be said to open it.
    """
    carrier = mechanism.carriers()
    names = {body_iri(mechanism.name, name): name for name in carrier}
    children = {joint.name: joint.child for joint in mechanism.joints}
    for subject, predicate, term in triples:
        if predicate not in {_HANDLE, _JOINT} or subject not in names:
            continue
        body, other = names[subject], local_name(str(value_of(term)))
        if predicate == _HANDLE and carrier.get(other) != carrier[body]:
            return f"handle '{other}' of '{body}' is not fixed to what moves '{body}'"
        if predicate == _JOINT and children.get(other) != carrier[body]:
            return f"joint '{other}' of '{body}' does not move it"
    return ""
