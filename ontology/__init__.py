"""Data of the project."""

from pathlib import Path


def path(name: str) -> Path:
    """Absolute path of a data file or folder of this package."""
    return Path(__file__).parent / name
