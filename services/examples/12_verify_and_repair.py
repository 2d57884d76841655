"""An agent proposes a body motion, is refused with typed reasons, repairs what they name, and is certified.

    python services/examples/12_verify_and_repair.py

The server is `sdt mcp`, started here as an agent's host starts it, and asked over standard input and output.
No language model is needed to close the loop: every reason carries a quantity, its value, its bound, the
time and the entity, and that is enough to repair by. The motion is one that was certified, then spoiled in
three ways at once: it starts 5 cm beside where the robot stands, one waypoint takes the tool off the
handle, and it is twice as fast as the robot can be.

    reason                                      repair, from its evidence
    a base joint starts at value, not at bound  shift it by bound - value
    the tool slips by value at a time           drop the waypoint that is nearest to the time
    a velocity or an acceleration is too high   stretch time by value / bound, or by its square root

One repair a round: later reasons are often consequences of the first. A reason that none of these repairs
ends the loop: it is shown, and nothing is claimed.
"""

import asyncio
import sys
from typing import Any, Final

import click
import numpy as np
from mcp import Client, StdioServerParameters, stdio_client

from services import load
from services.motions.files import arrays_of

KITCHEN: Final = "b"
ROBOT: Final = "pr2"
TASK: Final = "open:fridge_area_lower_drawer_main"
ROUNDS: Final = 8
SLOWER: Final = 1.01
"""[1] Stretched by so much more than needed: evidence is rounded to six digits."""

BASE: Final = ("base_x", "base_y", "base_yaw")
POSITIONS: Final = ("base", "robot_positions", "kitchen_positions")
VELOCITIES: Final = ("base_velocities", "robot_velocities", "kitchen_velocities")

Arrays = dict[str, np.ndarray]
Json = dict[str, Any]  # a JSON object


def certified() -> Arrays:
    """A body motion that the Law certifies: mode 1, generation."""
    (verdict,) = load(KITCHEN, robots=[ROBOT]).achieve(TASK)
    motion = verdict.case.body_motion
    return arrays_of(motion)  # pyright: ignore[reportArgumentType]  # known, since it is certified


def spoiled(motion: Arrays) -> Arrays:
    """The same, beside where the robot stands, off the handle at one waypoint, and twice as fast."""
    base, arm = motion["base"].copy(), motion["robot_positions"].copy()
    base[:, 0] += 0.05
    middle = (int(motion["phase_starts"][-1]) + len(arm)) // 2
    arm[middle, list(motion["robot_joint_names"]).index(_elbow(motion))] -= 0.02
    return _stretched({**motion, "base": base, "robot_positions": arm}, 0.5)


def repaired(motion: Arrays, reasons: list[Json]) -> tuple[Arrays, str] | None:
    """The motion with one reason less, and what was done; None where no repair is known."""
    measured = [each["evidence"] for each in reasons if each["evidence"]]
    for each in measured:
        if each["quantity"] == "position" and each.get("entity") in BASE and each["time"] == 0:
            by = each["bound"] - each["value"]
            shift = by * np.eye(3)[BASE.index(each["entity"])]
            return {
                **motion,
                "base": motion["base"] + shift,
            }, f"shift {each['entity']} by {by:g} {each['unit']}"
    slips = [each for each in measured if each["quantity"] == "tool_error"]
    if slips:
        worst = max(slips, key=lambda each: each["value"])
        index = int(np.abs(motion["times"] - worst["time"]).argmin())
        return _without(motion, index), f"drop waypoint {index}, at {motion['times'][index]:.2f} s"
    roots = {"velocity": 1.0, "acceleration": 0.5}
    factors = [
        (each["value"] / each["bound"]) ** roots[each["quantity"]]
        for each in measured
        if each["quantity"] in roots
    ]
    if not factors:
        return None
    factor = SLOWER * max(factors)
    return _stretched(motion, factor), f"stretch time by {factor:.4g}"


async def repair_loop(client: Client, motion: Arrays) -> list[str]:
    """Outcome of each round; the last is `certified`, or the loop gave up."""
    outcomes: list[str] = []
    for number in range(1, ROUNDS + 1):
        arrays = {name: array.tolist() for name, array in motion.items()}
        answer = await client.call_tool("verify_motion", {"task": TASK, "motion": arrays})
        if answer.is_error:
            click.echo(str(answer.structured_content))
            break
        (verdict,) = (answer.structured_content or {})["verdicts"]
        outcomes.append(verdict["outcome"])
        click.echo(f"round {number}: {verdict['outcome']}")
        for each in verdict["diagnoses"]:
            click.echo(f"  {each['kind']}: {each['reason']}")
        mended = None if verdict["outcome"] == "certified" else repaired(motion, verdict["diagnoses"])
        if mended is None:
            break
        motion, done = mended
        click.echo(f"  repair: {done}")
    return outcomes


async def main() -> list[str]:
    """A spoiled motion, repaired with what the server says."""
    words = ["-P", "-m", "services.cli", "mcp", "--kitchen", KITCHEN, "--robot", ROBOT]
    host = stdio_client(StdioServerParameters(command=sys.executable, args=words))
    async with Client(host) as client:
        return await repair_loop(client, spoiled(certified()))


def _elbow(motion: Arrays) -> str:
    """A joint of the arm that acts."""
    return next(str(name) for name in motion["robot_joint_names"] if "elbow" in str(name))


def _without(motion: Arrays, index: int) -> Arrays:
    """The motion without one sample; the spline goes from its neighbour to its neighbour."""
    sampled = {"times", *POSITIONS, *VELOCITIES}
    kept = {
        name: np.delete(each, index, axis=0) if name in sampled else each for name, each in motion.items()
    }
    starts = motion["phase_starts"]
    return {**kept, "phase_starts": starts - (starts > index)}


def _stretched(motion: Arrays, factor: float) -> Arrays:
    """The same path in `factor` times the time."""
    slower = {name: motion[name] / factor for name in VELOCITIES if name in motion}
    return {**motion, **slower, "times": motion["times"] * factor}


if __name__ == "__main__":
    sys.exit(0 if asyncio.run(main())[-1:] == ["certified"] else 1)
