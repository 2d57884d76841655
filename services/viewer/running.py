"""The page with its judges, from start to end."""

from collections.abc import Iterator
from contextlib import closing, contextmanager
from dataclasses import dataclass
from typing import TYPE_CHECKING

from sdt_kg.errors import InputError
from sdt_kg.load import model_name, model_path
from services.app import DEFAULT_BUDGET
from services.commands.importing import importing
from services.http.settings import Address
from services.viewer.judging.judges import Judges
from services.viewer.judging.question import Place

if TYPE_CHECKING:
    from services.viewer.page import Page


@dataclass(frozen=True, slots=True)
class Offer:
    """What can be chosen; the first of each is shown first.

    Attributes:
        kitchens, robots: Bundled names or paths.
        budget: Of a search [s].
        friction: With which fingers rub on handles at first [1]; None: verdicts say what is needed.
    """

    kitchens: tuple[str, ...]
    robots: tuple[str, ...]
    budget: float = DEFAULT_BUDGET
    friction: float | None = None


@contextmanager
def running(  # noqa: PLR0913 - what the command takes
    address: str,
    offer: Offer,
    judges: int = 1,
    hosts: tuple[str, ...] = (),
    *,
    unprotected: bool = False,
    patience: float = 0.0,
) -> Iterator["Page"]:
    """The page listens; at the end nothing of it is left.

    Args:
        address: HOST:PORT; port 0 is any free one.
        offer: What can be chosen.
        judges: Processes that judge; they get ready meanwhile.
        hosts: Other names of this service.
        unprotected: Whether it may listen where other machines reach it.
        patience: How long [s] it is waited for a judge that is not ready, so that it does not compete with a
            browser for the machine.

    Raises:
        InputError: A model that is none, a port that is taken, an address that others could reach.
    """
    where = Address.of(address)
    if not (where.is_loopback or unprotected):
        raise InputError(
            f"{where.host} can be reached from other machines, and the page knows no passwords",
            allowed="a loopback address",
            remedy="put a proxy with passwords in front of it; sdt view --unprotected listens there without",
        )
    kitchens, robots = _named("kitchen", offer.kitchens), _named("robot", offer.robots)
    first = Place(offer.kitchens[0], offer.robots[0])
    with closing(Judges(judges, first)) as judging:
        # Loaded while the judges load theirs: a person waits for the slower of both, not for their sum.
        with importing():
            from services.viewer.desk import Desk  # noqa: PLC0415
            from services.viewer.page import Page  # noqa: PLC0415

        desk = Desk(kitchens, robots, judging, offer.budget, offer.friction)
        twin = desk.twin(first)
        desk.kitchen(twin, first.kitchen)
        desk.robot(twin, first.robot)
        with closing(Page(where, desk, hosts)) as page:
            judging.wait(patience)
            yield page


def _named(kind: str, sources: tuple[str, ...]) -> dict[str, str]:
    """Name as it is shown → source."""
    found: dict[str, str] = {}
    for source in sources:
        model_path(kind, source)
        if model_name(source) in found:
            raise InputError(f"two {kind}s are named '{model_name(source)}'", allowed="each name once")
        found[model_name(source)] = source
    return found
