"""When no garbage is looked for: in what was imported, loaded or compiled is little, and it takes long."""

import gc
from collections.abc import Iterator
from contextlib import contextmanager


@contextmanager
def unsought(*, for_good: bool = False) -> Iterator[None]:
    """None is looked for meanwhile, and what was made is old afterwards: it is looked at last.

    Args:
        for_good: Whether it is never looked at: it goes with the process.
    """
    collects = gc.isenabled()
    gc.disable()
    try:
        yield
    finally:
        if collects or for_good:
            for_good = for_good or gc.get_freeze_count() > 0
            gc.freeze()
            if not for_good:
                gc.unfreeze()  # all of it is the oldest generation then
        if collects:
            gc.enable()
