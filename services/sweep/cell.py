"""One case of many, small enough to travel to a worker, and what became of it."""

from dataclasses import dataclass

from predicates.record import Record
from sdt_kg.load import model_name
from sdt_kg.task import Verb
from services.app import Policy
from services.relative import KINEMATIC, Relative


@dataclass(frozen=True, slots=True)
class Cell:
    """One case: one container of a kitchen in a state, one robot, one policy.

    Attributes:
        kitchen: Bundled name or path, as every worker can load it.
        robot: Likewise.
        task: `open:CONTAINER` or `close:CONTAINER`.
        states: `JOINT=VALUE` texts; empty is everything closed.
        relative: The class that the verdict is relative to.
    """

    kitchen: str
    robot: str
    task: str
    states: tuple[str, ...]
    policy: Policy
    relative: Relative = KINEMATIC

    def __str__(self) -> str:
        return f"{self.task}, {model_name(self.robot)} in {model_name(self.kitchen)}"

    @property
    def loaded(self) -> tuple[str, str, tuple[str, ...], Policy, Relative]:
        """What a worker loads for the case, and keeps for those that follow."""
        return self.kitchen, self.robot, self.states, self.policy, self.relative

    @property
    def verb(self) -> Verb:
        """What is to be done with the container."""
        return Verb(self.task.partition(":")[0])

    @property
    def container(self) -> str:
        """Name of the container."""
        return self.task.partition(":")[2]

    @property
    def file_name(self) -> str:
        """Where the case's certified body motion is kept, in a folder of motions."""
        container = self.container.replace("/", "_")  # links may have any name
        return f"{model_name(self.kitchen)}_{model_name(self.robot)}_{container}.npz"


@dataclass(frozen=True, slots=True)
class CellResult:
    """What a worker found: the verdict as the JSON object of `sdt achieve`, and as triples.

    Attributes:
        written: The triples; None where nobody is to keep them.
    """

    cell: Cell
    verdict: dict[str, object]
    written: Record | None

    @property
    def record(self) -> Record:
        """The triples, for who keeps them."""
        assert self.written is not None, "who keeps records asks for them"
        return self.written

    @property
    def stored(self) -> bool:
        """Whether the verdict was answered from the store, and is not to be written again."""
        return bool(self.verdict["stored"])


@dataclass(frozen=True, slots=True)
class Unjudged:
    """There is no verdict about the case: an oracle failed, or its process died twice.

    Attributes:
        reason: What was wrong.
    """

    cell: Cell
    reason: str


Found = CellResult | Unjudged
