"""Proofs about a set of grasps that say something else than was found: none of them holds."""

import base64
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

from sdt_kg.annotation import Drive
from sdt_kg.errors import InputError
from sdt_kg.twin import Twin
from services.embodiment.proof_check.proof.content import IN_HAND
from services.embodiment.prove import Proved
from tests.services.embodiment.prove.grasping import checked
from tests.services.embodiment.prove.standing import changed


def hard(whole: dict[str, Any]) -> dict[str, Any]:
    """The refutation that needs grasps: of the arm that comes nearer."""
    return max(whole["refutations"], key=lambda one: len(one["tree"]))


def of_every_hold(whole: dict[str, Any]) -> None:
    whole["claim"]["bar"] = None


def not_told(whole: dict[str, Any]) -> None:
    del whole["claim"]["bar"]


def of_another_bar(whole: dict[str, Any]) -> None:
    whole["claim"]["bar"]["centre"][2] += 0.3


def from_behind(whole: dict[str, Any]) -> None:
    bar = whole["claim"]["bar"]
    bar["outward"] = [-each for each in bar["outward"]]


def across(whole: dict[str, Any]) -> None:
    bar = whole["claim"]["bar"]
    bar["along"] = np.cross(bar["outward"], bar["along"]).tolist()
    bar["reach"] = 0.0


def of_its_middle(whole: dict[str, Any]) -> None:
    whole["claim"]["bar"]["reach"] -= 0.01


def askew(whole: dict[str, Any]) -> None:
    whole["claim"]["bar"]["along"][0] += 0.1


def of_a_point(whole: dict[str, Any]) -> None:
    whole["claim"]["bar"]["reach"] = -0.01


def in_hand(whole: dict[str, Any]) -> None:
    whole["claim"]["within"] = IN_HAND


def all_holds(whole: dict[str, Any]) -> None:
    hard(whole)["grasped"] = False


def between(whole: dict[str, Any]) -> None:
    hard(whole)["between"] = True


def earlier(whole: dict[str, Any]) -> None:
    for one in whole["refutations"]:
        one["value"] = 0.0


def free(whole: dict[str, Any]) -> None:
    whole["claim"]["drive"] = Drive.OMNI.value


def shorter(whole: dict[str, Any]) -> None:
    tree = base64.b64decode(hard(whole)["tree"])
    hard(whole)["tree"] = base64.b64encode(tree[:-1]).decode()


def one_sign(whole: dict[str, Any]) -> None:
    tree = base64.b64decode(hard(whole)["tree"])
    hard(whole)["tree"] = base64.b64encode(tree[: len(tree) // 2]).decode()


def older(whole: dict[str, Any]) -> None:
    whole["schema"] = "sdt proof 15"


def of_cells(whole: dict[str, Any]) -> None:
    whole["schema"] = "sdt proof 16"


CLAIMS = (
    of_every_hold,
    not_told,
    of_another_bar,
    from_behind,
    across,
    of_its_middle,
    askew,
    of_a_point,
    in_hand,
)


@pytest.mark.parametrize(
    "change", [*CLAIMS, all_holds, between, earlier, free, shorter, one_sign, older, of_cells]
)
def test_a_changed_proof_does_not_hold(
    never: tuple[Twin, Proved], change: Callable[[dict[str, Any]], None]
) -> None:
    twin, proved = never
    try:
        assert not checked(twin, changed(proved.artefact.content, change))
    except InputError:
        assert change in {not_told, older, of_cells}
