"""What is stored, checked again by `sdt recheck`, in a process of its own that is killed when it is late."""

import asyncio
import hashlib
import json
import sys
import tempfile
from collections.abc import Iterable
from dataclasses import dataclass, field
from datetime import UTC, datetime
from pathlib import Path
from typing import Any, Final

import pyoxigraph as ox

from sdt_kg.errors import InputError, OracleUnavailableError
from sdt_kg.iri import LAW, Iri
from services.http.problems import RefusedError
from services.http.world import World, lines
from services.store.workers import BusyError

SECONDS: Final = 180.0
"""[s] A recheck may take; a certificate of a long motion takes some ten."""
BAD_INPUT: Final = 2
"""Exit code of `sdt` where the line on standard error says what is wrong."""
WAITING: Final = 4
"""Rechecks that may wait for another."""
OF_STEP: Final = ox.NamedNode(LAW + "verdict")
"""From the step of a task's result to its verdict."""
MOST: Final = 1000
"""Results that are remembered."""

Json = dict[str, Any]  # JSON object


@dataclass
class Rechecks:
    """What was checked again since the service began; nothing of it is written.

    Attributes:
        world: Where verdicts and models are.
    """

    world: World
    _results: dict[tuple[Iri, str], Json] = field(default_factory=dict[tuple[Iri, str], Json])
    _waiting: int = 0

    def __post_init__(self) -> None:
        self._turn = asyncio.Lock()

    def known(self, judged: Iri, quads: Iterable[ox.Quad]) -> Json | None:
        """What the last recheck of this very record found; None where there was none."""
        return self._results.get((judged, _digest(quads)))

    async def check(self, judged: Iri) -> Json:
        """What `sdt recheck` says of a verdict, or of a task's result, and when.

        Raises:
            InputError: It says that there is nothing to check.
            BusyError: Too many are waiting.
            RefusedError: It took too long, and was killed.
            OracleUnavailableError: It could not be run.
        """
        if self._waiting >= WAITING:
            raise BusyError(f"{self._waiting} rechecks are waiting already: ask again later")
        self._waiting += 1
        try:
            async with self._turn:
                return await self._checked(judged)
        finally:
            self._waiting -= 1

    async def _checked(self, judged: Iri) -> Json:
        record = await self.world.recall(judged)
        if not record:
            raise InputError(f"no verdict or result <{judged}>", remedy="/verdicts and /tasks list them")
        quads = list(ox.parse(record, format=ox.RdfFormat.N_QUADS))
        for step in [each.object.value for each in quads if each.predicate == OF_STEP]:
            record += await self.world.recall(step)
        with tempfile.TemporaryDirectory(prefix="sdt-recheck-") as folder:
            saved = Path(folder) / "verdict.nq"
            saved.write_bytes(await self._with_models(record, quads))
            found = await _run("recheck", judged, "--store", str(saved), "--json")
        (result,) = json.loads(found)
        result["time"] = datetime.now(UTC).isoformat(timespec="seconds")
        while len(self._results) >= MOST:
            del self._results[next(iter(self._results))]
        self._results[judged, _digest(quads)] = result
        return result

    async def _with_models(self, record: bytes, quads: list[ox.Quad]) -> bytes:
        """The records with the models that they are about, where these are served."""
        named = {quad.object.value for quad in quads if isinstance(quad.object, ox.NamedNode)}
        for kitchen in self.world.kitchens.values():
            if kitchen.twin.environment in named:
                return record + await asyncio.to_thread(kitchen.twin.serialize, "nquads")
        return record


async def _run(*words: str) -> bytes:
    """What `sdt` prints; it ends with this task at the latest."""
    command = (sys.executable, "-m", "services.cli", *words)
    pipe = asyncio.subprocess.PIPE
    child = await asyncio.create_subprocess_exec(
        *command, stdin=asyncio.subprocess.DEVNULL, stdout=pipe, stderr=pipe
    )
    try:
        async with asyncio.timeout(SECONDS):
            printed, complained = await child.communicate()
    except TimeoutError:
        raise RefusedError(504, f"the recheck was not done after {SECONDS:g} s") from None
    finally:
        if child.returncode is None:
            child.kill()
            await child.wait()
    if child.returncode == BAD_INPUT:
        last = complained.decode(errors="replace").strip().splitlines()[-1:]
        raise InputError("".join(last).removeprefix("error: "))
    if not printed:
        raise OracleUnavailableError(f"the recheck ended with exit code {child.returncode} and no answer")
    return printed


def _digest(quads: Iterable[ox.Quad]) -> str:
    """Of a record, whatever the order of its lines."""
    return hashlib.sha256(b"".join(sorted(lines([each]) for each in quads))).hexdigest()
