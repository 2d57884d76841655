r"""Terms of Φ′ that only forces show: a latch to overcome, or a door that is pushed in and springs out.

Read from a log with the hand's force on the handle. Three explanations compete:

- plain: the force grows until friction is overcome and stays there,
- latch: it grows to a threshold, the latch gives way, and friction alone remains,
- push to open: it is negative first, the container goes in, is let go and comes out by itself.
"""

from predicates.learn.articulation import Articulation
from predicates.learn.holding.latch import Latch, Plain, latch
from predicates.learn.holding.log import log_of
from predicates.learn.holding.push import PushToOpen, push
from predicates.learn.track import Track

__all__ = ["Latch", "Plain", "PushToOpen", "phases"]


def phases(track: Track, joint: Articulation) -> Latch | PushToOpen | Plain:
    """What held the container before it moved along the joint that was learned.

    Raises:
        MotionError: The track has no forces, or the joint does not move.
    """
    log = log_of(track, joint)
    pushed = push(log)
    return latch(log) if pushed is None else pushed
