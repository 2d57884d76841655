"""Where a base may stand, asked with the words that people type."""

from sdt_kg.iri import Iri
from sdt_kg.twin import Twin
from services.embodiment.place.answer import Json, to_json
from services.embodiment.place.search import place
from services.requests import task_of_one


def placed(  # noqa: PLR0913  # what is asked
    twin: Twin, robot: Iri, task: str, *, budget: float, seed: int, friction: float | None
) -> Json:
    """The placement's JSON object, of what `place` answers.

    Args:
        twin: Kitchen and robot, in the state in which the motion begins.
        robot: IRI of a robot of the twin.
        task: `open:CONTAINER` or `close:CONTAINER`.
        budget: Seconds of CPU.
        seed: Of the search.
        friction: With which coefficient fingers rub on handles [1]; None: a certificate says what it takes.

    Raises:
        InputError: The task names no container.
        UnknownEntityError: The kitchen has no such container.
    """
    return to_json(place(twin, robot, task_of_one(twin, task), budget, seed, friction=friction))
