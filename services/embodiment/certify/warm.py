"""The certifier's compiled loops are loaded, or compiled, before any clock runs and before workers begin."""

import numpy as np

from services.embodiment.certify.held.pressed import depths, frames
from services.embodiment.certify.sweep.clearance import Pairs, Sweep
from services.embodiment.certify.sweep.pieces import hermite
from services.embodiment.certify.sweep.subject import subject
from services.embodiment.certify.tolerances import Tolerances
from services.physics.model import Scene

FAR = 1e6  # [m] a distance that nothing keeps, so that every loop has something to look at


def warm(scene: Scene) -> None:
    """Every compiled function has run once, with the types in which it is used."""
    q = np.tile(scene.q((0.0, 0.0, 0.0), {}), (2, 1))
    q[1, scene.base[0]] += 1.0
    pieces = hermite(np.arange(2.0), q, np.zeros_like(q))
    checked = subject(scene, pieces, Tolerances())
    pairs = np.concatenate((scene.environment_pairs, scene.self_pairs))[:1]
    least = np.full(len(pairs), FAR)
    sets = [Pairs(pairs, least, least, np.inf)]
    Sweep(checked.timeline, checked.kinematics, checked.shapes, sets).run(FAR)
    first = checked.pieces.columns(pieces.moving).c[:2, 0]
    placed = checked.kinematics.place(first[:1], first[1:])
    checked.pieces.at(np.zeros(1, np.intp), np.zeros(1))
    for finger, handle in pairs.tolist():
        depths(checked, placed, finger, frames(checked, placed, handle), np.zeros((1, 3)))
