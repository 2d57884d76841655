"""What is drawn in which colour, as red, green, blue in [0, 1]; the same in pages, figures and tables.

Outcomes are told apart by lightness and by words too, so that they read in grey and for the colour-blind.
"""

from typing import Final

Color = tuple[float, float, float]

COLORS: Final[dict[str, Color]] = {
    "kitchen": (0.86, 0.84, 0.80),
    "container": (0.93, 0.90, 0.83),
    "handle": (0.33, 0.33, 0.36),
    "robot": (0.44, 0.55, 0.67),
    "finger": (0.20, 0.29, 0.41),
    "red": (0.84, 0.15, 0.16),
    "path": (0.80, 0.08, 0.10),
    "gap": (0.55, 0.00, 0.60),
    "seen": (0.05, 0.45, 0.30),
    "learned": (0.00, 0.36, 0.75),
    "certified": (0.16, 0.48, 0.31),
    "not_certified": (0.93, 0.72, 0.42),
    "proved": (0.76, 0.29, 0.20),
    "abstained": (0.80, 0.80, 0.82),
}


def css(name: str) -> str:
    """The colour as CSS writes it."""
    return "#" + "".join(f"{round(255 * part):02x}" for part in COLORS[name])
