"""Holds without the reference: trees, counted containers, handles that can be grasped, annotations."""

from collections import Counter
from dataclasses import replace

import numpy as np
import rdflib

import kitchens
from sdt_kg import iri

SDT = rdflib.Namespace(iri.SDT)
START = {"a": (1.5, 2.0), "b": (0.0, 0.0)}
GAP = 0.013  # [m] least free width behind a bar: cabinet11_drawer_middle, as in the reference
MIDDLE = 0.8  # share of a bar, without its ends, where a gripper takes it


def test_kitchen_is_a_tree(kitchen):
    assert max(Counter(kitchen.end(joint, "child") for joint in kitchen.joints.values()).values()) == 1
    assert len(kitchen.links) == len(kitchen.joints) + 1
    assert len(kitchen.frames({})) == len(kitchen.links)


def test_counted_containers_exist(kitchen, name, doors, drawers):
    assert (len(set(doors)), len(set(drawers))) == {"a": (8, 19), "b": (3, 14)}[name]
    kinds = {link: kitchen.above[link].get("type") for link in doors + drawers}
    assert kinds == dict.fromkeys(doors, "revolute") | dict.fromkeys(drawers, "prismatic")
    for link in doors + drawers:
        lower, upper, velocity, _ = kitchen.limits(str(kitchen.above[link].get("name")))
        assert lower == 0 < upper
        assert velocity > 0


def test_every_counted_container_has_one_handle(kitchen, doors, drawers):
    for link in doors + drawers:
        assert [len(kitchen.shapes(handle)) > 0 for handle in kitchen.handles(link)] == [True], link


def grid(shape, step=0.004):
    """Points through a box, in the link's frame."""
    axes = [np.linspace(-side / 2, side / 2, int(side / step) + 2) for side in shape.size]
    local = np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1).reshape(-1, 3)
    return local @ shape.pose[:3, :3].T + shape.pose[:3, 3]


def gap_behind_bar(kitchen, link):
    """Free width between the bar of a handle and its container [m]."""
    frames = kitchen.frames({})
    (handle,) = kitchen.handles(link)
    bar = max(kitchen.shapes(handle), key=lambda shape: shape.size.prod())
    bar = replace(bar, size=np.where(bar.size == bar.size.max(), MIDDLE, 1.0) * bar.size)
    link_T_handle = np.linalg.inv(frames[link]) @ frames[handle]
    points = grid(bar) @ link_T_handle[:3, :3].T + link_T_handle[:3, 3]
    return min(shape.distance(points).min() for shape in kitchen.shapes(link))


def test_fingers_fit_behind_every_bar(kitchen, doors, drawers):
    for link in doors + drawers:
        gap = gap_behind_bar(kitchen, link)
        assert gap > GAP, f"{link}: {gap:.4f} m between bar and container"


def test_shapes_have_extent(kitchen):
    sizes = np.concatenate([shape.size for link in kitchen.links for shape in kitchen.shapes(link)])
    assert np.isfinite(sizes).all()
    assert sizes.min() > 0


def test_annotation_gives_start_pose_and_accelerations(kitchen, name, doors, drawers):
    graph = rdflib.Graph().parse(kitchens.path(f"{name}/{name}.ttl"))
    environment = rdflib.URIRef(iri.model_iri(name))
    start = graph.value(environment, SDT.startPose)
    assert (float(graph.value(start, SDT.x)), float(graph.value(start, SDT.y))) == START[name]
    assert all(graph.value(start, SDT[key]) is not None for key in ("z", "qx", "qy", "qz", "qw"))
    assert (environment, rdflib.DCTERMS.source, None) in graph
    given = {iri.local_name(str(joint)) for joint in graph.subjects(SDT.accelerationLimit)}
    needed = {str(kitchen.above[link].get("name")) for link in doors + drawers}
    leaders = {
        str(joint.find("mimic").get("joint"))
        for joint in kitchen.joints.values()
        if joint.find("mimic") is not None
    }
    assert needed | leaders <= given <= set(kitchen.movable())
