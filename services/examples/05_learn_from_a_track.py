"""Something was seen to move: which joint moved it, and what was the task (mode 3)?"""
# What was asked for is known in the answers below, which types alone do not say.
# pyright: reportArgumentType=false, reportAttributeAccessIssue=false

import numpy as np

from predicates.learn import Track, learn
from sdt_kg.iri import local_name
from services import load
from services.learning import seen_in
from services.physics.chain import chain
from services.physics.tree import build

# A point on a handle, 30 times a second, with 2 mm of noise: here made up, else from a camera.
angle = np.concatenate([np.zeros(30), np.linspace(0, 1.2, 120), np.full(30, 1.2)])
circle = 0.4 * np.column_stack([np.cos(angle), np.sin(angle), np.zeros_like(angle)])
noise = np.random.default_rng(0).normal(0, 0.002, circle.shape)
learned = learn(Track(np.array([1.0, 0.2, 0.9]) + circle + noise, np.arange(len(angle)) / 30, timed=True))

best = learned.best
print(best.joint_type.value, "axis", np.round(best.axis, 2), f"radius {best.radius:.3f} m")
for candidate, probability in zip(learned.candidates, learned.probabilities, strict=True):
    print(f"  {candidate.joint_type.value}: probability {probability:.3g}")

# In a kitchen: what a camera would see of a drawer of kitchen B that is pulled out almost to its end.
kitchen = load("b")
twin, drawer = kitchen.twin, kitchen.twin.container("sink_area_left_middle_drawer_main")
handle = chain(build(twin.mechanism(twin.environment)), drawer.handle, twin.state)
pulled = 0.95 * drawer.upper * (1 - np.cos(np.linspace(0, np.pi, 60))) / 2
points = handle.poses(pulled)[0][:, :3, 3]
points += np.random.default_rng(1).normal(0, 0.002, points.shape)
seen = seen_in(twin, learn(Track(points, np.arange(60) / 20, timed=True)), kitchen.physics)
print(seen.followed.container.name, [local_name(task.container) for task in seen.explanation.tasks])
