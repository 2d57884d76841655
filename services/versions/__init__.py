"""Versions of this installation's oracles, as verdicts name them; no oracle is loaded to tell them.

They are inputs of a verdict, whose IRI is the hash of all inputs (ARCHITECTURE, decision 8): what another
version judged is not the answer to a question that is asked now.
"""

from collections.abc import Mapping
from functools import cache
from importlib.metadata import version

KINEMATICS_VERSION = "23"
DYNAMICS_VERSION = "9"
EMBODIMENT_VERSION = "53"
BEARING_VERSION = "7"
"""Each is raised whenever an answer of that oracle may change."""

ORACLES = ("physics", "embodiment")
"""Inputs of a verdict that name who judged."""
OURS = frozenset({"kinematics", "dynamics", "whole body", "bearing"})
"""How these names begin where one of the oracles above judged."""


@cache
def version_of(package: str) -> str:
    """The version of an installed package; looked for once."""
    return version(package)


def kinematics() -> str:
    """Φ of rigid bodies."""
    return f"kinematics {KINEMATICS_VERSION}, pin {version_of('pin')}"


def dynamics() -> str:
    """Φ with forces."""
    return f"dynamics {DYNAMICS_VERSION}, {kinematics()}"


def whole_body() -> str:
    """R: base, torso, arm and gripper."""
    return f"whole body {EMBODIMENT_VERSION}, pin {version_of('pin')}, coal {version_of('coal')}"


def bearing(inner: str) -> str:
    """R that has to bear forces, on top of another."""
    return f"bearing {BEARING_VERSION}, {inner}"


def outdated(inputs: Mapping[str, str]) -> tuple[str, ...]:
    """What judged in another version than is here, `kinematics 9 (here 10)`; empty: the verdict answers.

    An oracle that is not one of ours has no version here: what it judged is not outdated.
    """
    told = (each for name in ORACLES if name in inputs for each in _others(inputs[name]))
    return tuple(dict.fromkeys(told))


@cache
def _others(oracle: str) -> tuple[str, ...]:
    """Parts of an oracle's version that are here in another one."""
    here, there = _parts(f"{dynamics()}, {bearing(whole_body())}"), _parts(oracle)
    if next(iter(there)) not in OURS:
        return ()
    return tuple(
        f"{name} {number} (here {here[name]})"
        for name, number in there.items()
        if here.get(name, number) != number
    )


def _parts(oracle: str) -> dict[str, str]:
    """Name → version: of the oracle first, then of what it rests on."""
    parts = (each.rpartition(" ") for each in oracle.split(", "))
    return {name: number for name, _, number in parts}
