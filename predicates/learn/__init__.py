"""Learning from observation: which joint moves what was seen, and what the twin would have to say."""

from predicates.learn.articulation import Articulation, Learned
from predicates.learn.choose import UP, learn
from predicates.learn.track import Track

__all__ = ["UP", "Articulation", "Learned", "Track", "learn"]
