"""Where a joint's own limits leave it a way, and those of another one that it moves with do not."""

from sdt_kg.entities.coupling import LIMIT_TOLERANCE, Coupling
from sdt_kg.iri import Iri, local_name


def narrowed(coupling: Coupling, joint: Iri) -> str:
    """Which coupling leaves a joint least of its own limits, and what to do; empty where none takes any."""
    own = coupling.joints[joint].limits
    left = [(*_left(coupling, joint, other), other) for other in coupling.together(joint)]
    least = min(left, key=lambda each: each[1] - each[0], default=(own.lower, own.upper, joint))
    low, high, other = least
    if high - low >= own.upper - own.lower - LIMIT_TOLERANCE:
        return ""
    limits = coupling.joints[other].limits
    name, another = local_name(joint), local_name(other)
    way = f"leaves '{name}' {low:g} to {high:g}" if low <= high else f"leaves '{name}' nothing"
    return (
        f"{_mimic(coupling, other if other in coupling.followers else joint)}; '{another}' may be at "
        f"{limits.lower:g} to {limits.upper:g}, which {way} of its own {own.lower:g} to {own.upper:g}: "
        "let the sign of the multiplier, the axis and the limits of the two agree"
    )


def _left(coupling: Coupling, joint: Iri, other: Iri) -> tuple[float, float]:
    """Between which of its own positions a joint leaves another its limits; the first above, if none."""
    own, limits = coupling.joints[joint].limits, coupling.joints[other].limits
    ratio, offset = coupling.together(joint)[other]
    one, two = sorted((end - offset) / ratio + 0.0 for end in (limits.lower, limits.upper))
    return max(own.lower, one), min(own.upper, two)


def _mimic(coupling: Coupling, follower: Iri) -> str:
    """How a joint follows another, as the model is read: signs are those of axes that reading has turned."""
    mimic, turned = coupling.followers[follower], coupling.joints[follower].turned
    beside = f" and offset {mimic.offset:g}" if mimic.offset else ""
    said = (
        f"'{local_name(follower)}' mimics '{local_name(mimic.active)}' with multiplier {mimic.multiplier:g}"
    )
    return said + beside + (f" (in its file it has {turned})" if turned else "")
