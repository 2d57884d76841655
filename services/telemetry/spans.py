"""OpenTelemetry spans of requests, in a file, only where one is named; a caller's traceparent is taken up."""

from pathlib import Path
from typing import Any, Protocol

from sdt_kg.errors import InputError


class Span(Protocol):
    """Something under way; ended once."""

    @property
    def traceparent(self) -> str:
        """For what is done below it; empty where nothing is recorded."""
        ...

    def end(self, **attributes: str | float) -> None:
        """It is over, with what is to be told of it."""
        ...


class Spans(Protocol):
    """Who records spans."""

    def begin(self, name: str, traceparent: str = "", **attributes: str | float) -> Span:
        """A span from now on, below the one of the traceparent."""
        ...


class NoSpans:
    """Nothing is recorded; a caller's trace context is handed on as it is."""

    def begin(self, name: str, traceparent: str = "", **attributes: str | float) -> Span:
        """Nothing happens."""
        del name, attributes
        return _Nothing(traceparent)


class SpansInFile:
    """Spans as JSON lines in a file, each when it ends.

    Args:
        file: Appended to.

    Raises:
        InputError: OpenTelemetry is not installed.
    """

    def __init__(self, file: Path) -> None:
        try:
            from opentelemetry.sdk.resources import Resource  # noqa: PLC0415 - an extra
            from opentelemetry.sdk.trace import TracerProvider, export  # noqa: PLC0415 - see above
            from opentelemetry.trace.propagation import tracecontext  # noqa: PLC0415 - see above
        except ModuleNotFoundError as error:
            if not (error.name or "").startswith("opentelemetry"):
                raise
            raise InputError(
                "spans need OpenTelemetry",
                allowed="sdt-kg with its extra",
                remedy="pip install 'sdt-kg[telemetry]'",
            ) from None
        self._file = file.open("a")
        self._provider = TracerProvider(resource=Resource({"service.name": "sdt"}))
        exporter = export.ConsoleSpanExporter(
            out=self._file, formatter=lambda span: f"{span.to_json(indent=None)}\n"
        )
        self._provider.add_span_processor(export.SimpleSpanProcessor(exporter))
        self._tracer = self._provider.get_tracer("sdt")
        self._context = tracecontext.TraceContextTextMapPropagator()

    def begin(self, name: str, traceparent: str = "", **attributes: str | float) -> Span:
        """A span from now on, below the one of the traceparent; one that is not valid begins a trace."""
        parent = self._context.extract({"traceparent": traceparent})
        return _Recorded(self._tracer.start_span(name, parent, attributes=attributes))

    def close(self) -> None:
        """Everything is in the file."""
        self._provider.shutdown()
        self._file.close()


class _Nothing:
    def __init__(self, traceparent: str) -> None:
        self.traceparent = traceparent

    def end(self, **attributes: str | float) -> None:
        del attributes


class _Recorded:
    def __init__(self, span: Any) -> None:  # noqa: ANN401 - of an extra
        self._span = span

    @property
    def traceparent(self) -> str:
        at = self._span.get_span_context()
        return f"00-{at.trace_id:032x}-{at.span_id:016x}-{at.trace_flags:02x}"

    def end(self, **attributes: str | float) -> None:
        self._span.set_attributes(attributes)
        self._span.end()
