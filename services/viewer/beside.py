"""The 3D page beside the HTTP service, if it is asked for."""

from collections.abc import Iterator
from contextlib import contextmanager
from importlib.util import find_spec

from sdt_kg.errors import InputError


@contextmanager
def page_beside(
    address: str | None, kitchens: tuple[str, ...], robots: tuple[str, ...]
) -> Iterator[str | None]:
    """Origin of the page, to which other pages link; None where none is asked for.

    Raises:
        InputError: viser is not installed, there is nothing to show, or the address is not free.
    """
    if address is None:
        yield None
        return
    if not (kitchens and robots):
        raise InputError(
            "the 3D page has nothing to show", allowed="--kitchen and --robot, each once or more"
        )
    check_extra()
    from services.viewer.running import Offer, running  # noqa: PLC0415 - its library is an extra

    with running(address, Offer(kitchens, robots)) as page:
        yield page.url.rstrip("/")


def check_extra() -> None:
    """The library of the page is there.

    Raises:
        InputError: It is not; the extra is named.
    """
    if find_spec("viser") is None:
        raise InputError("the 3D page needs viser, not installed here", remedy="pip install 'sdt-kg[view]'")
