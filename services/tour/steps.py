"""What the tour shows, in the order in which it is shown."""

from dataclasses import dataclass
from typing import Final

from services.commands.exits import Exit

DOOR: Final = "iai_fridge_door"
MOTION: Final = "fridge.npz"
VERDICTS: Final = "tour.trig"
TRACK: Final = "seen.csv"
NOISE: Final = 0.002
"""[m] Standard deviation of what the pretended camera sees; that of a good marker tracker."""

_CASE: Final = ("achieve", "--kitchen", "b", "--robot", "pr2", "--task", f"open:{DOOR}")


@dataclass(frozen=True, slots=True)
class Step:
    """One stop of the tour.

    Attributes:
        title: Where we are.
        says: What is about to happen, and why.
        words: What is typed after `sdt`.
        look: What to look at in the answer.
        ends: The exit code with which it ends when all is well.
        prepares: Whether the tour first writes what a camera would have seen.
    """

    title: str
    says: str
    words: tuple[str, ...]
    look: str
    ends: Exit = Exit.DONE
    prepares: bool = False


STEPS: Final = (
    Step(
        "The world is a graph",
        "Kitchen B is a URDF that was read into triples: bodies, joints, handles, limits. A door or "
        "drawer with a handle is a container, and can be asked about.",
        (
            "query",
            "b",
            "SELECT ?door ?upper { ?door a sdt:Door ; sdt:hasJoint ?joint . ?joint sdt:upperLimit ?upper }",
        ),
        "Three doors, each with the limit of its joint in rad. sdt containers b shows the drawers, too.",
    ),
    Step(
        "Mode 1, generation: make a motion",
        "Can the PR2 open the fridge? Nothing is known but the task. The final state comes from Eq. (8), "
        "the door's motion from the physics, the body's motion from the planner; then other code checks "
        "all of it.",
        (*_CASE, "--motion-out", MOTION, "--save", VERDICTS),
        "Three times yes, and then what it rests on: the smallest distances, how far the tool slips, what"
        " was assumed. The last line names the verdict: a hash of everything that was asked.",
    ),
    Step(
        "Mode 2, verification: judge a motion",
        f"The same question, with the body motion in {MOTION}. No planner runs: the motion is replayed and"
        " checked as it is. A motion of your own planner goes the same way.",
        (*_CASE, "--motion", MOTION),
        "Certified again, in a fraction of the time, under another name: a given motion is another input.",
    ),
    Step(
        "Mode 3, learning: what was it that was seen?",
        f"{TRACK} is where the handle was in that motion, as a camera would see it with 2 mm of noise. "
        "Nobody says which door it is, or that it is a door.",
        ("learn", TRACK, "--kitchen", "b"),
        "A revolute joint, its axis and radius with their uncertainty, and which request the motion meets: "
        f"open:{DOOR}.",
        prepares=True,
    ),
    Step(
        "Mode 4, what if: the same in another world",
        "Would it still work if the PR2 could not drive?",
        ("whatif", "--kitchen", "b", "--robot", "pr2", "--task", f"open:{DOOR}", "--edit", "drive:fixed"),
        "CanPerform turns, and the reason is proved: every posture of the class is refuted, not only "
        "those that were tried. The exit code 1 says that the other world's answer is no.",
        ends=Exit.NO,
    ),
    Step(
        "A verdict can be asked why",
        f"The verdict of mode 1 was kept in {VERDICTS}, with its certificate.",
        ("why", VERDICTS),
        "What was asked, the answer of each predicate, the margins, and how to check it again.",
    ),
    Step(
        "A verdict can be checked again",
        "Without the code that planned or proved it; on another machine, too.",
        ("recheck", VERDICTS),
        "The certificate holds. sdt serve --store shows the same verdicts as pages, sdt view the motion "
        "in 3D.",
    ),
)
