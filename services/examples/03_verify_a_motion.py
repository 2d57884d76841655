"""Judge a motion: your planner proposes, the Law disposes (mode 2)."""
# What was asked for is known in the answers below, which types alone do not say.
# pyright: reportArgumentType=false, reportAttributeAccessIssue=false

from dataclasses import replace
from pathlib import Path
from tempfile import TemporaryDirectory

from services import load
from services.motions import read_motion, write_motion

TASK = "open:sink_area_left_middle_drawer_main"
kitchen = load("b", robots=["pr2"])
(made,) = kitchen.achieve(TASK)  # mode 1 stands for your planner here

# A body motion is arrays: times (T,), base (T, 3), joints (T, n) and their rates. Files hold the same.
with TemporaryDirectory() as folder:
    path = Path(folder) / "drawer.npz"  # .json, .csv and ROS 2 bags will do, too
    write_motion(path, made.case.body_motion)
    motion = read_motion(path, kitchen.twin, kitchen.robot("pr2"))
print(f"{len(motion.times)} samples of {len(motion.joints)} joints in {motion.times[-1]:.1f} s")

(verdict,) = kitchen.achieve(TASK, motion=motion)
print("as it is:", verdict.outcome.value)

# Twice as fast: the same path, and more than the joints can do.
fast = replace(motion, times=motion.times / 2, v=motion.v * 2, base_v=motion.base_v * 2)
fast = replace(fast, kitchen_v=motion.kitchen_v * 2)
(verdict,) = kitchen.achieve(TASK, motion=fast)
print("twice as fast:", verdict.outcome.value)
for diagnosis in verdict.diagnoses[:3]:
    print(f"  {diagnosis.kind.value}: {diagnosis.reason}")
