"""Counts and latencies of a service, in Prometheus' text format."""

import threading
from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass, field
from typing import Final

MEDIA: Final = "text/plain; version=0.0.4; charset=utf-8"
BUCKETS: Final = (
    0.001,
    0.0025,
    0.005,
    0.01,
    0.025,
    0.05,
    0.1,
    0.25,
    0.5,
    1.0,
    2.5,
    5.0,
    10.0,
    30.0,
    60.0,
    120.0,
)
"""[s] Upper bounds of latencies; from a query's milliseconds to a search's minutes."""

Labels = tuple[tuple[str, str], ...]
Gauge = Callable[[], float]

HELP: Final = {
    "sdt_requests_total": "Requests by surface, what was asked, and how they ended.",
    "sdt_request_seconds": "Seconds from request to answer.",
    "sdt_verdicts_total": "Verdicts that were answered, by outcome; stored: answered from the store.",
    "sdt_step_seconds": "Seconds of each step of new verdicts: satisfies request, causes, model, certify …",
    "sdt_shared_total": "Questions that were answered together with an equal one at the same time.",
    "sdt_jobs_waiting": "Questions that wait for a process that judges.",
    "sdt_processes": "Processes that judge.",
    "sdt_process_deaths_total": "Processes that died while they judged.",
    "sdt_process_replacements_total": "Processes that were replaced, because they held too much memory.",
    "sdt_process_resident_bytes": "Memory of the processes that judge, all together.",
    "sdt_jobs_refused_total": "Questions that were refused, because too many were waiting.",
    "sdt_deadlines_missed_total": "Questions whose deadline passed first.",
}


@dataclass(slots=True)
class _Histogram:
    buckets: list[int] = field(default_factory=lambda: [0] * len(BUCKETS))
    count: int = 0
    total: float = 0.0


@dataclass(frozen=True, slots=True)
class Judged:
    """One verdict, as it is counted.

    Attributes:
        outcome: certified, not_certified or abstained.
        stored: Whether it was answered from the store.
        seconds: Step → time [s].
    """

    outcome: str
    stored: bool
    seconds: Mapping[str, float]


class Metrics:
    """What is counted; any thread may count."""

    def __init__(self) -> None:
        self._lock = threading.Lock()
        self._counters: dict[str, dict[Labels, float]] = {}
        self._histograms: dict[str, dict[Labels, _Histogram]] = {}
        self._gauges: dict[str, tuple[str, Gauge]] = {}

    def count(self, name: str, **labels: str) -> None:
        """One more."""
        key = tuple(labels.items())
        with self._lock:
            counters = self._counters.setdefault(name, {})
            counters[key] = counters.get(key, 0) + 1

    def observe(self, name: str, seconds: float, **labels: str) -> None:
        """One more that took so long."""
        key = tuple(labels.items())
        with self._lock:
            one = self._histograms.setdefault(name, {}).setdefault(key, _Histogram())
            one.count += 1
            one.total += seconds
            for index, bound in enumerate(BUCKETS):
                if seconds <= bound:
                    one.buckets[index] += 1

    def asked(self, surface: str, what: str, end: str, seconds: float) -> None:
        """A request ended: `answer`, or the kind of its problem."""
        self.count("sdt_requests_total", surface=surface, what=what, end=end)
        self.observe("sdt_request_seconds", seconds, surface=surface, what=what)

    def judged(self, verdicts: Iterable[Judged]) -> None:
        """Verdicts were answered."""
        for each in verdicts:
            self.count("sdt_verdicts_total", outcome=each.outcome, stored=str(each.stored).lower())
            if not each.stored:
                for step, seconds in each.seconds.items():
                    self.observe("sdt_step_seconds", seconds, step=step)

    def gauge(self, name: str, value: Gauge, kind: str = "gauge") -> None:
        """A figure that is read when it is asked for."""
        self._gauges[name] = (kind, value)

    def text(self) -> str:
        """Everything, as Prometheus reads it."""
        return "\n".join([*self._lines(), ""])

    def to_json(self) -> dict[str, float]:
        """Counters and gauges by name and labels."""
        with self._lock:
            counted = {
                f"{name}{_labels(key)}": value
                for name, values in self._counters.items()
                for key, value in values.items()
            }
        return counted | {name: read() for name, (_, read) in self._gauges.items()}

    def _lines(self) -> Iterator[str]:
        with self._lock:
            for name, values in self._counters.items():
                yield from _head(name, "counter")
                yield from (f"{name}{_labels(key)} {value:g}" for key, value in values.items())
            for name, found in self._histograms.items():
                yield from _head(name, "histogram")
                for key, one in found.items():
                    yield from _histogram(name, key, one)
        for name, (kind, read) in self._gauges.items():
            yield from _head(name, kind)
            yield f"{name} {read():g}"


def _head(name: str, kind: str) -> Iterator[str]:
    yield f"# HELP {name} {HELP[name]}"
    yield f"# TYPE {name} {kind}"


def _histogram(name: str, key: Labels, one: _Histogram) -> Iterator[str]:
    for bound, count in zip(BUCKETS, one.buckets, strict=True):
        yield f"{name}_bucket{_labels((*key, ('le', f'{bound:g}')))} {count}"
    yield f"{name}_bucket{_labels((*key, ('le', '+Inf')))} {one.count}"
    yield f"{name}_sum{_labels(key)} {one.total:.9g}"
    yield f"{name}_count{_labels(key)} {one.count}"


def _labels(key: Labels) -> str:
    escaped = (
        (name, value.replace("\\", "\\\\").replace('"', '\\"').replace("\n", "\\n")) for name, value in key
    )
    inner = ",".join(f'{name}="{value}"' for name, value in escaped)
    return f"{{{inner}}}" if inner else ""
