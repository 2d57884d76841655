"""What a service tells of itself, handed to its parts."""

from dataclasses import dataclass, field

from services.telemetry.metrics import Metrics
from services.telemetry.spans import NoSpans, Spans


@dataclass(frozen=True, slots=True)
class Telemetry:
    """Counts and spans of one service.

    Attributes:
        metrics: Always counted.
        spans: Recorded only where somebody asked for it.
    """

    metrics: Metrics = field(default_factory=Metrics)
    spans: Spans = field(default_factory=NoSpans)
