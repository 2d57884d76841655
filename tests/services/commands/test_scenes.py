"""MJCF and SDF files stand wherever a kitchen's URDF does."""

from pathlib import Path

import pytest

from sdt_kg.urdf import read_mechanism
from tests.sdt_kg.scenes.writers import mjcf, sdf
from tests.small import FOLDER


def test_containers_of_a_scene_and_what_was_left_out_of_it(sdt, tmp_path: Path) -> None:
    mechanism = read_mechanism(FOLDER / "b.urdf", turn_axes=True)
    for suffix, text in ((".xml", mjcf(mechanism)), (".sdf", sdf(mechanism))):
        path = tmp_path / f"scene{suffix}"
        path.write_text(text, encoding="utf-8")
        done = sdt("containers", str(path), "--json")
        assert [row["name"] for row in done.json] == ["oven_door", "top_drawer"]
        assert sdt("satisfies", str(path), "--state", "top_drawer=open").code == 0
    assert "MJCF has no velocity limits" in sdt("containers", str(tmp_path / "scene.xml")).err
    assert sdt("containers", str(tmp_path / "nowhere.xml")).code == 2


def test_without_velocity_limits_a_request_is_out_of_scope_until_an_annotation_gives_them(
    sdt, tmp_path: Path
) -> None:
    mechanism = read_mechanism(FOLDER / "b.urdf", turn_axes=True)
    (tmp_path / "k.xml").write_text(mjcf(mechanism), encoding="utf-8")
    done = sdt("causes", str(tmp_path / "k.xml"), "--task", "open:top_drawer")
    assert done.code == 3
    assert "velocity limit" in done.out
    (tmp_path / "k.ttl").write_text(ANNOTATION, encoding="utf-8")
    assert sdt("causes", str(tmp_path / "k.xml"), "--task", "open:top_drawer").code == 0
    assert sdt("causes", str(tmp_path / "k.xml"), "--task", "open:oven_door").code == 3


ANNOTATION = """@prefix sdt: <https://example.org/sdt#> .
<https://example.org/id/k> a sdt:Environment ; sdt:startPose <https://example.org/id/k/start> .
<https://example.org/id/k/start> a sdt:Pose ;
  sdt:x 0.0 ; sdt:y 0.0 ; sdt:z 0.0 ; sdt:qx 0.0 ; sdt:qy 0.0 ; sdt:qz 0.0 ; sdt:qw 1.0 .
<https://example.org/id/k/joint/top_drawer_joint> sdt:velocityLimit 0.5 .
"""


@pytest.mark.parametrize("text", ["", "<html/>", "<mujoco>"])
def test_what_is_no_scene_is_refused_in_one_line(sdt, tmp_path: Path, text: str) -> None:
    (tmp_path / "s.xml").write_text(text, encoding="utf-8")
    done = sdt("containers", str(tmp_path / "s.xml"))
    assert done.code == 2
    assert done.err.count("\n") == 1
