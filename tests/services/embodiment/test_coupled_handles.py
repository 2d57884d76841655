"""Doors that more than one handle opens, their own or that of a door which moves with them."""

from dataclasses import replace
from pathlib import Path

import pytest

from predicates.case import Case, Outcome, Verdict
from predicates.law import law
from predicates.meant import handles_of_no_container
from sdt_kg.annotation import Drive
from sdt_kg.errors import UnknownEntityError
from sdt_kg.iri import local_name
from sdt_kg.task import Task, Verb
from sdt_kg.twin import Twin
from services.embodiment.certify.certificate import read_certificate
from services.embodiment.oracle import WholeBody
from services.embodiment.place.grid import Status
from services.embodiment.place.search import place
from services.embodiment.proof_check import check
from services.embodiment.proof_check.proof.content import Proof
from services.embodiment.proof_check.proof.written import read_proof, to_bytes
from services.embodiment.recheck import recheck_artefact
from services.embodiment.recheck.embodiment import Certifier
from services.physics.oracle import Kinematics
from services.store.files import SavedVerdicts
from tests.services.embodiment.test_recheck import recheck
from tests.small import beside

pytestmark = pytest.mark.oracle

BAR, POST = "0.012 0.012 0.16", "0.039 0.012 0.012"
HIGH = 2.6  # [m] which no gripper of Stretch comes to


def box(size: str, at: str) -> str:
    return f'<collision><origin xyz="{at}"/><geometry><box size="{size}"/></geometry></collision>'


def door(name: str, side: int, height: float, more: str = "") -> str:
    """A door with its hinge 0.405 m to a side, and a bar near its free edge."""
    bar = box(BAR, "-0.055 0 0") + box(POST, "-0.0295 0 0.074") + box(POST, "-0.0295 0 -0.074")
    return f"""<link name="{name}_door">{box("0.02 0.4 0.5", f"0 {-0.2 * side} 0")}</link>
<joint name="{name}_door_joint" type="revolute"><parent link="wall"/><child link="{name}_door"/>
<origin xyz="0 {0.405 * side} {height}"/><axis xyz="0 0 {-side}"/>
<limit lower="0" upper="1.4" velocity="1" effort="1"/>{more}</joint><link name="{name}_handle">{bar}</link>
<joint name="{name}_handle_joint" type="fixed"><parent link="{name}_door"/><child link="{name}_handle"/>
<origin xyz="0 {-0.35 * side} 0"/></joint>"""


def pair(folder: Path, low: float, robot: str = "stretch") -> Twin:
    """The right door is followed by the left one, which is too high."""
    file = folder / "pair.urdf"
    file.write_text(f"""<robot name="pair"><link name="world"/>
<link name="wall">{box("0.02 6 3", "0.6 0 1.5")}</link>
<joint name="wall_joint" type="fixed"><parent link="world"/><child link="wall"/>
<origin xyz="1.2 0 0"/></joint>
{door("right", -1, low)}{door("left", 1, HIGH, '<mimic joint="right_door_joint"/>')}</robot>""")
    return beside(file, robot)


def judged(twin: Twin) -> Verdict:
    task = Task(Verb.OPEN, twin.container("left_door").iri)
    (verdict,) = law(Case(twin, twin.robots[0], task), Kinematics(), WholeBody(Drive.OMNI))
    return verdict


def kept(folder: Path, verdict: Verdict) -> Path:
    file = folder / "kept.nq"
    with SavedVerdicts(file) as saved:
        saved.add_twin(verdict.case.twin)
        saved.add(verdict)
    return file


def test_a_door_is_opened_by_the_handle_of_the_one_that_it_follows(tmp_path: Path) -> None:
    twin = pair(tmp_path, 1.0)
    verdict = judged(twin)
    assert verdict.outcome is Outcome.CERTIFIED
    assert verdict.can_perform is not None
    assert verdict.can_perform.artefact is not None
    assert "held by right_handle: left_door moves with right_door" in verdict.can_perform.notes
    certificate = read_certificate(verdict.can_perform.artefact.content)
    assert certificate.container == twin.container("right_door").iri
    assert recheck(kept(tmp_path, verdict)).reasons == ()


def proof_of(verdict: Verdict) -> Proof:
    assert verdict.outcome is Outcome.NOT_CERTIFIED
    assert verdict.can_perform is not None
    assert verdict.can_perform.artefact is not None
    assert all(each.proof for each in verdict.diagnoses)
    return read_proof(verdict.can_perform.artefact.content)


def test_of_doors_that_move_together_each_handle_is_proved_too_high(tmp_path: Path) -> None:
    twin = pair(tmp_path, HIGH)
    verdict = judged(twin)
    proof, left = proof_of(verdict), twin.container("left_door")
    assert [one.claim.container for one in proof.others] == [twin.container("right_door").iri]
    assert recheck(kept(tmp_path, verdict)).reasons == ()
    (other,) = proof.others
    low, high = other.claim.span
    for changed, reason in (
        ((), "right_handle moves left_door, too, and of it nothing is proved"),
        ((replace(other, refutations=()),), "of right_handle: gripper"),
        ((replace(other, claim=replace(other.claim, container=left.iri)),), "of it nothing is proved"),
        ((replace(other, claim=replace(other.claim, drive=Drive.FIXED)),), "for the base policy fixed"),
        ((replace(other, claim=replace(other.claim, declared=True)),), "alone"),
        ((replace(other, claim=replace(other.claim, span=(low - 0.1, high))),), "need not pass all of"),
        ((replace(other, claim=replace(other.claim, span=(low, high + 0.1))),), "need not pass all of"),
    ):
        content = to_bytes(replace(proof, others=changed))
        found = recheck_artefact("changed", content, lambda *_: (twin, "given"))
        assert any(reason in each for each in found.reasons), found.reasons
    placed = place(twin, twin.robots[0], Task(Verb.OPEN, twin.container("left_door").iri), budget=2.0)
    assert not any(cell.status is Status.PROVED for row in placed.rows for cell in row)


def test_where_a_handle_of_no_container_moves_a_door_nothing_is_proved_of_the_door(tmp_path: Path) -> None:
    pair(tmp_path, 1.0)
    file = tmp_path / "pair.urdf"
    more = 'parent link="{}"/><child link="right_handle"/>'
    front = '<link name="front"/><joint name="front_joint" type="fixed"><parent link="right_door"/>'
    front += '<child link="front"/></joint></robot>'
    text = file.read_text().replace(more.format("right_door"), more.format("front"))
    file.write_text(text.replace("</robot>", front))
    twin = beside(file, "stretch")
    assert [each.name for each in twin.containers()] == ["left_door"]
    left = twin.container("left_door")
    assert [local_name(each) for each in handles_of_no_container(twin, left)] == ["right_handle"]
    verdict = judged(twin)
    assert verdict.outcome is Outcome.NOT_CERTIFIED
    assert not any(each.proof for each in verdict.diagnoses)
    assert verdict.can_perform is not None
    assert verdict.can_perform.artefact is None
    assert "not looked for by right_handle, which is no container's" in verdict.can_perform.notes
    alone = proof_of(opened(tall(tmp_path, None), WholeBody(Drive.OMNI)))
    found = check(twin, twin.robots[0], left, to_bytes(alone))
    assert any(each.startswith("right_handle moves left_door, too, though") for each in found.reasons)
    placed = place(twin, twin.robots[0], Task(Verb.OPEN, left.iri), budget=2.0)
    assert not any(cell.status is Status.PROVED for row in placed.rows for cell in row)


def tall(folder: Path, low: float | None, robot: str = "stretch", size: str = BAR) -> Twin:
    """A door with a handle that is too high, and perhaps another one, so much lower."""
    more = f"""<link name="more_handle">{box(size, "0 0 0")}</link>
<joint name="more_joint" type="fixed"><parent link="tall_door"/><child link="more_handle"/>
<origin xyz="-0.055 -0.35 -{low}"/></joint>"""
    high = door("tall", 1, HIGH).replace("tall_handle", "high_handle")
    file = folder / "tall.urdf"
    file.write_text(f'<robot name="tall"><link name="wall"/>{high}{more if low else ""}</robot>')
    return beside(file, robot)


def opened(twin: Twin, judge: WholeBody) -> Verdict:
    (verdict,) = law(
        Case(twin, twin.robots[0], Task(Verb.OPEN, twin.container("tall_door").iri)), Kinematics(), judge
    )
    return verdict


def test_a_door_is_opened_by_the_other_of_its_handles(tmp_path: Path) -> None:
    twin = tall(tmp_path, 1.6)
    verdict = opened(twin, WholeBody(Drive.OMNI))
    assert verdict.outcome is Outcome.CERTIFIED
    assert verdict.can_perform is not None
    assert verdict.can_perform.artefact is not None
    assert "held by more_handle, another handle of tall_door" in verdict.can_perform.notes
    certificate = read_certificate(verdict.can_perform.artefact.content)
    assert local_name(certificate.held_in(twin).handle) == "more_handle"
    with pytest.raises(UnknownEntityError, match="handle of tall_door"):
        replace(certificate, handle=twin.container("tall_door").iri).held_in(twin)
    given = replace(verdict.case, body_motion=certificate.motion)
    (again,) = law(given, Kinematics(), WholeBody(Drive.OMNI))
    assert again.outcome is Outcome.CERTIFIED
    assert recheck(kept(tmp_path, verdict)).reasons == ()
    by_own = replace(certificate, handle=None)
    assert Certifier(twin, by_own).perform(given).holds is False


@pytest.mark.parametrize(("low", "certified"), [(1.6, True), (0.1, False)])
def test_a_handle_on_what_is_mounted_on_a_door_is_another_of_its_handles(
    tmp_path: Path, low: float, certified: bool
) -> None:
    tall(tmp_path, low)
    file, mount = tmp_path / "tall.urdf", '<link name="mount"/><joint name="mount_joint" type="fixed">'
    more = 'parent link="{}"/><child link="more_handle"/>'
    text = file.read_text().replace(more.format("tall_door"), more.format("mount"))
    mount += '<parent link="tall_door"/><child link="mount"/></joint></robot>'
    file.write_text(text.replace("</robot>", mount))
    twin = beside(file, "stretch")
    (container,) = twin.containers()
    assert local_name(container.handle) == "high_handle"
    assert [local_name(each) for each in container.more_handles] == ["more_handle"]
    verdict = opened(twin, WholeBody(Drive.OMNI))
    assert recheck(kept(tmp_path, verdict)).reasons == ()
    if certified:
        assert verdict.outcome is Outcome.CERTIFIED
        assert verdict.can_perform is not None
        assert "held by more_handle, another handle of tall_door" in verdict.can_perform.notes
        return
    assert len(proof_of(verdict).others) == 1


def test_a_base_has_its_place_by_another_handle(tmp_path: Path) -> None:
    two, moved = tall(tmp_path, 1.6, "tiago_dual"), pair(tmp_path, 1.0, "tiago_dual")
    for twin, name in ((two, "tall_door"), (moved, "left_door")):
        task = Task(Verb.OPEN, twin.container(name).iri)
        assert place(twin, twin.robots[0], task, budget=20.0, enough=1).spots


@pytest.mark.parametrize("drive", [Drive.OMNI, Drive.FIXED])
@pytest.mark.parametrize(("low", "others"), [(None, 0), (0.1, 1)])
def test_each_of_two_handles_is_proved_too_high(
    tmp_path: Path, low: float | None, others: int, drive: Drive
) -> None:
    verdict = opened(tall(tmp_path, low), WholeBody(drive))
    proof = proof_of(verdict)
    assert len(proof.others) == others
    found = recheck(kept(tmp_path, verdict))
    assert found.reasons == ()
    assert any("held by more_handle" in each for each in found.notes) is bool(others)
    assert verdict.can_perform is not None
    turned = [each for each in verdict.can_perform.notes if each.startswith("for more_handle start: x ")]
    assert len(turned) == others


def test_a_proof_of_one_handle_does_not_stand_in_for_another(tmp_path: Path) -> None:
    twin = tall(tmp_path, 0.1)
    proof = proof_of(opened(twin, WholeBody(Drive.OMNI)))
    (other,) = proof.others
    container = twin.container("tall_door")
    for changed in (replace(proof, others=(proof,)), other, replace(other, others=(proof,))):
        assert not check(twin, twin.robots[0], container, to_bytes(changed)).holds


def test_what_is_proved_of_one_of_two_handles_is_no_proof_about_their_door(tmp_path: Path) -> None:
    verdict = opened(tall(tmp_path, 1.6, size="0.3 0.3 0.3"), WholeBody(Drive.OMNI))
    assert verdict.outcome is Outcome.NOT_CERTIFIED
    assert not any(each.proof for each in verdict.diagnoses)
    assert verdict.can_perform is not None
    assert verdict.can_perform.artefact is None
    assert "nor by more_handle, as far as was looked" in verdict.can_perform.notes


def test_where_forces_are_asked_a_door_is_held_by_none_of_another_door(tmp_path: Path) -> None:
    twin = pair(tmp_path, 1.0)
    task = Task(Verb.OPEN, twin.container("left_door").iri)
    (verdict,) = law(Case(twin, twin.robots[0], task), Kinematics(), WholeBody(Drive.OMNI, coupled=False))
    assert verdict.outcome is Outcome.NOT_CERTIFIED
    assert verdict.can_perform is not None
    assert "not looked for by right_handle, where the force would be another" in verdict.can_perform.notes
    assert not any(each.proof for each in verdict.diagnoses)
