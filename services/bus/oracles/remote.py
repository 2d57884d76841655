"""The Physics and Embodiment Protocols, answered by oracles on the bus."""

from collections.abc import Iterator
from dataclasses import dataclass, replace
from functools import cached_property, partial

import zenoh

from predicates.case import Answer, Case
from predicates.oracle import Embodiment, Physics, Replayed
from sdt_kg.iri import Iri
from sdt_kg.motion import BodyMotion, Motion
from sdt_kg.scope import D_ARTIC, D_ARTIC_DYN, TeeClass
from sdt_kg.state import Region
from sdt_kg.twin import Container, Twin
from services.app import Oracles, Policy
from services.bus.keys import Oracle
from services.bus.oracles.bound import UnfitReplyError, answer_to, check_replayed, replayed_of
from services.bus.oracles.callers import Callers, Pinned
from services.bus.oracles.codec import (
    Plain,
    case_plain,
    motion_plain,
    motion_value,
    policy_plain,
    region_plain,
)
from services.bus.oracles.own import own_embodiment, own_physics
from services.bus.sessions import Reach

MARGIN = 30.0
"""[s] Beyond a search's budget."""


@dataclass(frozen=True)
class RemotePhysics:
    """Φ on the bus; where it is the one that this process has, it has to say the same."""

    pinned: Pinned

    @cached_property
    def here(self) -> Physics:
        """Φ of this process."""
        return own_physics(self.pinned.callers.tee)

    @property
    def tee_class(self) -> TeeClass:
        """D."""
        return D_ARTIC if self.pinned.callers.tee == "d_artic" else D_ARTIC_DYN

    @property
    def version(self) -> str:
        """The oracle's own, as it is now."""
        return self.pinned.version()

    def replay(self, twin: Twin, motion: Motion) -> Replayed:
        """Final state under the motion."""
        read = partial(self._replayed, twin, motion)
        return self.pinned.call("replay", twin, read, motion=motion_plain(motion))

    def _replayed(self, twin: Twin, motion: Motion, said: Plain) -> Replayed:
        told = replayed_of(twin, motion, said)
        if self.pinned.told == self.here.version:
            check_replayed(told, self.here.replay(twin, motion))
        return told

    def generate(self, twin: Twin, goal: Region) -> Iterator[Motion]:
        """Motions into the region, best first."""
        yield from self.pinned.call("generate", twin, _motions, goal=region_plain(goal))

    def carried(self, twin: Twin, body_motion: BodyMotion, container: Container) -> Motion:
        """τ under a body motion."""
        plain = motion_plain(body_motion)
        return self.pinned.call("carried", twin, _motion, body_motion=plain, container=container.iri)


@dataclass(frozen=True)
class RemoteEmbodiment:
    """CanPerform on the bus, under a policy: searched there, and what is found is certified here too."""

    pinned: Pinned
    policy: Policy

    @cached_property
    def here(self) -> Embodiment:
        """R of this process under the same policy, which is asked about motions that were found."""
        return own_embodiment(self.pinned.callers.tee, self.policy)

    @property
    def version(self) -> str:
        """The oracle's own, as it is now."""
        return self.pinned.version()

    def settings(self, twin: Twin, robot: Iri) -> tuple[tuple[str, str], ...]:
        """What decides the answer beyond the case; of this process's version it is what that has."""
        return self.pinned.call("settings", twin, partial(self._settings, twin, robot), robot=robot)

    def _settings(self, twin: Twin, robot: Iri, said: object) -> tuple[tuple[str, str], ...]:
        told = _settings(said)
        if self.pinned.told == self.here.version and told != self.here.settings(twin, robot):
            raise UnfitReplyError("these are not the settings of that version and policy")
        return told

    def perform(self, case: Case) -> Answer:
        """Body motion that follows the case's motion, certified; or the verification of its own."""
        read = partial(answer_to, case, self.policy, self.here)
        seconds = self.policy.budget + MARGIN
        return self.pinned.call("perform", case.twin, read, seconds, case=case_plain(case))


@dataclass(frozen=True, slots=True)
class OnBus:
    """How a process that judges gets its oracles: a session of its own; picklable."""

    reach: Reach

    def __call__(self) -> Oracles:
        """The oracles that are reached."""
        oracles = BusOracles.on(self.reach())
        return oracles  # pyright: ignore[reportReturnType]  # it caches what the Protocol has as an attribute


@dataclass(frozen=True, slots=True)
class BusOracles:
    """Both oracles, wherever on the bus they are: what a `Service` takes as its oracles."""

    causes: Callers
    canperform: Callers

    @staticmethod
    def on(session: zenoh.Session) -> "BusOracles":
        """The oracles that this session reaches."""
        return BusOracles(Callers(session, Oracle.CAUSES), Callers(session, Oracle.CANPERFORM))

    def with_forces(self) -> "BusOracles":
        """The same oracles where forces count."""
        return BusOracles(*(replace(each, tee="d_artic_dyn") for each in (self.causes, self.canperform)))

    def physics(self) -> RemotePhysics:
        """Φ."""
        return RemotePhysics(Pinned(self.causes))

    def embodiment(self, policy: Policy) -> RemoteEmbodiment:
        """R under a policy."""
        pinned = Pinned(self.canperform, {"policy": policy_plain(policy)})
        return RemoteEmbodiment(pinned, policy)


def _settings(said: object) -> tuple[tuple[str, str], ...]:
    """Name and value of each; no name twice."""
    pairs = [tuple(each) for each in said if isinstance(each, list)] if isinstance(said, list) else []
    texts = [each for each in pairs if [type(one) for one in each] == [str, str]]
    if not isinstance(said, list) or not len(said) == len(texts) == len(dict(texts)):
        raise UnfitReplyError("these are no settings")
    return tuple(texts)


def _motion(said: Plain) -> Motion:
    return motion_value(Motion, said)


def _motions(said: object) -> list[Motion]:
    if not isinstance(said, list):
        raise UnfitReplyError("these are no motions")
    return [_motion(each) for each in said]
