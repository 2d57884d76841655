"""Content negotiation: which of our media types a client takes, best first (RFC 9110, section 12.5.1)."""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass

from services.store.workers.evaluate import GRAPHS, TABLES

HTML = "text/html"
ALIASES: Mapping[str, tuple[str, ...]] = {
    "application/sparql-results+json": ("application/json",),
    "application/sparql-results+xml": ("application/xml", "text/xml"),
    "application/n-triples": ("text/plain",),
    "application/ld+json": ("application/json",),
    "text/turtle": ("application/x-turtle",),
}
"""Names that clients use for the same thing; the answer is then called what it was asked for."""

EXACTLY = 2


@dataclass(frozen=True, slots=True)
class _Range:
    kind: str
    sub: str
    quality: float

    def specificity(self, media: str) -> int:
        """How well the range fits: 2 exactly, 1 by its kind, 0 as anything, -1 not at all."""
        kind, _, sub = media.partition("/")
        if (self.kind, self.sub) == (kind, sub):
            return EXACTLY
        if (self.kind, self.sub) == (kind, "*"):
            return 1
        return 0 if (self.kind, self.sub) == ("*", "*") else -1


def accepted(header: str | None, offers: Iterable[str] = (*TABLES, *GRAPHS)) -> tuple[str, ...]:
    """Those of the offers which the client takes, best first; equals keep their order."""
    ranges = _ranges(header)
    qualities = {offer: max(quality for _, quality in _called(offer, ranges)) for offer in offers}
    taken = [offer for offer, quality in qualities.items() if quality > 0]
    return tuple(sorted(taken, key=lambda offer: -qualities[offer]))


def called(media: str, header: str | None) -> str:
    """Content-Type of an answer of that media type: as the client called it, text as UTF-8."""
    ranges = _ranges(header)
    best, _ = max(_called(media, ranges), key=lambda each: each[1])
    return f"{best}; charset=utf-8" if best.startswith("text/") else best


def _called(media: str, ranges: Iterable[_Range]) -> list[tuple[str, float]]:
    """Each name of the media type and its quality; an alias counts only where the client spells it."""
    aliases = [(name, each) for name in ALIASES.get(media, ()) for each in ranges]
    spelled = [(name, each.quality) for name, each in aliases if each.specificity(name) == EXACTLY]
    return [(media, _quality(media, ranges)), *spelled]


def _ranges(header: str | None) -> list[_Range]:
    """The header's media ranges; without one, anything."""
    ranges: list[_Range] = []
    for part in (header or "*/*").split(","):
        media, *parameters = (each.strip().lower() for each in part.split(";"))
        kind, slash, sub = media.partition("/")
        if slash and kind and sub:
            ranges.append(_Range(kind, sub, _weight(parameters)))
    return ranges


def _weight(parameters: Iterable[str]) -> float:
    for parameter in parameters:
        name, _, value = parameter.partition("=")
        if name.strip() == "q":
            try:
                return min(1.0, max(0.0, float(value)))
            except ValueError:
                return 0.0
    return 1.0


def _quality(media: str, ranges: Iterable[_Range]) -> float:
    """Of the most specific range that fits; 0 where none does."""
    fitting = [(each.specificity(media), each.quality) for each in ranges]
    best = max(fitting, default=(-1, 0.0))
    return best[1] if best[0] >= 0 else 0.0
