"""A kitchen with robots, paths and clips: as a page's 3D view, and as arrays for a picture on paper."""

import base64
import html
import json
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import asdict, dataclass
from functools import cache
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from sdt_kg.iri import Iri, body_iri, local_name
from sdt_kg.twin import Twin
from services.physics.chain import chain
from services.physics.model import Scene
from services.physics.tree import build
from services.reports.scene.camera import ASPECT, Camera, overview
from services.reports.scene.clip import Clip, Line
from services.reports.scene.colors import COLORS
from services.reports.scene.tree import Tree, kitchen_tree, robot_tree

Array = NDArray[np.float64]

PATH_POINTS = 24
"""[1] Of a handle's path."""


@dataclass(frozen=True, slots=True, eq=False)
class View:
    """What is shown.

    Attributes:
        title: What a reader sees here.
        trees: The kitchen first, then the robots.
        clips: What can be chosen; the first is shown at the beginning.
        lines: What is drawn in every clip.
        kinds: Body IRI → name in `colors.COLORS`; bodies that are not listed are kitchen or robot.
        camera: From where it is seen at first.
    """

    title: str
    trees: tuple[Tree, ...]
    clips: tuple[Clip, ...]
    lines: tuple[Line, ...]
    kinds: dict[Iri, str]
    camera: Camera

    def kind(self, tree: Tree, body: Iri) -> str:
        """What a body is, for its colour."""
        return self.kinds.get(body, "robot" if tree.is_robot else "kitchen")

    def _repr_html_(self) -> str:
        """The view with playback: canvas, data and viewer in one piece of HTML that loads nothing."""
        data = json.dumps(payload(self), separators=(",", ":")).replace("<", "\\u003c")
        return (
            f'<figure class="sdt-view"><style>{_file("viewer.css")}</style>'
            f'<div class="sdt-stage"></div><figcaption>{html.escape(self.title)}</figcaption>'
            f'<script type="application/json">{data}</script>'
            f"<script>{_file('viewer.js')}</script></figure>"
        )


def view_of(twin: Twin, scenes: Sequence[Scene], title: str, clips: Iterable[Clip] = ()) -> View:
    """The kitchen in its present state, with the path of every handle that can still be moved.

    Args:
        twin: Kitchen and state.
        scenes: One for each robot that is shown.
        title: What a reader sees here.
        clips: What can be chosen; without one, the kitchen as it stands.
    """
    kitchen = kitchen_tree(twin)
    trees = (kitchen, *map(robot_tree, scenes))
    shown = tuple(clips) or (Clip("as it stands", trees[1].name if len(trees) > 1 else "", np.zeros(1)),)
    start = twin.kitchen().start
    paths = tuple(handle_paths(twin, kitchen))
    handles = np.vstack([each.points for each in paths]) if paths else np.zeros((0, 3))
    return View(title, trees, shown, paths, _kinds(twin, scenes), overview(handles, (start[0], start[1])))


def handle_paths(twin: Twin, kitchen: Tree) -> Iterator[Line]:
    """From where each container is to where it is wholly open; none for one that is open."""
    model = build(twin.mechanism(twin.environment))
    frames, bodies = kitchen.frames(kitchen.rest), {each.iri: each for each in kitchen.bodies}
    for each in twin.containers():
        now = twin.state.get(each.active_joint, 0.0)
        end = (each.upper - each.offset) / each.multiplier
        if not np.isfinite(end) or each.is_open(each.multiplier * now + each.offset):
            continue
        path = chain(model, each.handle, twin.state)
        poses, _ = path.poses(np.linspace(now, end, PATH_POINTS))
        world_T_handle, centre = path.poses(np.array([now]))[0][0], np.zeros(3)
        if each.handle in bodies:
            points = bodies[each.handle].mesh.placed(frames[bodies[each.handle].joint]).vertices
            middle = (points.min(axis=0) + points.max(axis=0)) / 2
            centre = world_T_handle[:3, :3].T @ (middle - world_T_handle[:3, 3])
        yield Line(poses[:, :3, :3] @ centre + poses[:, :3, 3], each.name)


def _kinds(twin: Twin, scenes: Sequence[Scene]) -> dict[Iri, str]:
    kinds = {each.iri: "container" for each in twin.containers()}
    kinds |= {each.handle: "handle" for each in twin.containers() if each.handle != each.iri}
    for scene in scenes:
        for gripper in scene.annotation.grippers:
            for body in gripper.fingers:
                kinds[body_iri(scene.robot.mechanism.name, body)] = "finger"
    return kinds


def payload(view: View) -> dict[str, object]:
    """What the viewer reads; arrays are little-endian, in base 64."""
    indices = {each.name: i for i, each in enumerate(view.trees)}
    return {
        "title": view.title,
        "colors": COLORS,
        "camera": asdict(view.camera),
        "aspect": ASPECT,
        "trees": [_tree(view, each) for each in view.trees],
        "clips": [_clip(each, indices) for each in view.clips],
        "lines": [_line(each) for each in view.lines],
    }


def _tree(view: View, tree: Tree) -> dict[str, object]:
    """Bodies one after the other in shared arrays, each with where its part begins and how long it is."""
    meshes = [each.mesh for each in tree.bodies]
    starts = np.cumsum([0, *(len(each.vertices) for each in meshes)])[:-1]
    faces = [each.faces + start for each, start in zip(meshes, starts, strict=True)]
    edges = [each.edges + start for each, start in zip(meshes, starts, strict=True)]
    return {
        "name": tree.name,
        "robot": tree.is_robot,
        "joints": list(tree.joints),
        "parents": tree.parents.tolist(),
        "placements": _floats(tree.placements[:, :3, :]),
        "axes": _floats(tree.axes),
        "slides": tree.slides.astype(int).tolist(),
        "rest": _floats(tree.rest),
        "vertices": _floats(np.vstack([each.vertices for each in meshes])),
        "faces": _whole(np.vstack(faces)),
        "edges": _whole(np.vstack(edges)),
        "bodies": [
            [
                each.iri,
                local_name(each.iri),
                each.joint,
                view.kind(tree, each.iri),
                3 * len(mesh.faces),
                2 * len(mesh.edges),
            ]
            for each, mesh in zip(tree.bodies, meshes, strict=True)
        ],
    }


def _clip(clip: Clip, indices: dict[str, int]) -> dict[str, object]:
    return {
        "name": clip.name,
        "trees": [0, indices[clip.robot]] if clip.robot else [0],
        "times": _floats(clip.times),
        "joints": list(clip.joints),
        "values": _floats(clip.values),
        "phases": [[name, round(begin, 3)] for name, begin in clip.phases],
        "red": sorted(clip.red),
        "ghost": clip.ghost,
        "lines": [_line(each) for each in clip.lines],
        "note": clip.note,
        "camera": None if clip.camera is None else asdict(clip.camera),
    }


def _line(line: Line) -> dict[str, object]:
    return {"points": _floats(line.points), "label": line.label, "color": line.color}


def _floats(array: Array) -> str:
    return base64.b64encode(np.ascontiguousarray(array, dtype="<f4").tobytes()).decode()


def _whole(array: NDArray[np.intp]) -> str:
    return base64.b64encode(np.ascontiguousarray(array, dtype="<u4").tobytes()).decode()


@cache
def _file(name: str) -> str:
    return (Path(__file__).parent / name).read_text()
