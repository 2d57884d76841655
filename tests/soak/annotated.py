"""A robot's or a kitchen's annotation as other code reads it: rdflib, and no class of ours."""

from pathlib import Path

import numpy as np
import rdflib
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

Array = NDArray[np.float64]
SDT = rdflib.Namespace("https://example.org/sdt#")


class Note:
    """What a robot's annotation says.

    Attributes:
        base: Speed, turning speed, acceleration, turning acceleration.
        grippers: Name → tool's body, body_T_tool, links of the fingers.
        touching: Pairs of links that may touch.
    """

    def __init__(self, file: Path) -> None:
        graph = rdflib.Graph().parse(file)
        robot = graph.value(predicate=rdflib.RDF.type, object=SDT.Robot)

        def number(name: str) -> float:
            return float(graph.value(robot, SDT[name]))

        names = ("LinearVelocity", "AngularVelocity", "LinearAcceleration", "AngularAcceleration")
        self.base = [number(f"base{name}") for name in names]
        self.height, self.overhang = number("baseHeight"), number("overhang")
        self.base_body = _name(graph.value(robot, SDT.baseBody))
        self.accelerations = accelerations(file)
        self.parked = {_name(s): float(o) for s, o in graph.subject_objects(SDT.parkedPosition)}
        self.touching = {frozenset((_name(s), _name(o))) for s, o in graph.subject_objects(SDT.mayTouch)}
        self.grippers: dict[str, tuple[str, Array, set[str]]] = {}
        for one in graph.objects(robot, SDT.hasGripper):
            fingers = {_name(each) for each in graph.objects(one, SDT.hasFinger)}
            tool = _name(graph.value(one, SDT.toolBody)), _pose(graph, graph.value(one, SDT.toolFrame))
            self.grippers[str(graph.value(one, rdflib.RDFS.label))] = (*tool, fingers)


def accelerations(file: Path) -> dict[str, float]:
    """Joint → acceleration limit, as an annotation has them."""
    return {_name(s): float(o) for s, o in rdflib.Graph().parse(file)[: SDT.accelerationLimit]}


def _name(iri: object) -> str:
    return str(iri).rsplit("/", 1)[1]


def _pose(graph: rdflib.Graph, node: object) -> Array:
    x, y, z, *turn = (float(graph.value(node, SDT[key])) for key in ("x", "y", "z", "qx", "qy", "qz", "qw"))
    pose = np.eye(4)
    pose[:3, :3], pose[:3, 3] = Rotation.from_quat(turn).as_matrix(), (x, y, z)
    return pose
