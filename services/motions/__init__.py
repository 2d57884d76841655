"""Motions in files: a robot's body motion, or a container's motion. README.md is the schema."""

from services.motions.files import (
    arrays_of,
    check_format,
    motion_of,
    read_arrays,
    read_motion,
    write_arrays,
    write_motion,
)

__all__ = [
    "arrays_of",
    "check_format",
    "motion_of",
    "read_arrays",
    "read_motion",
    "write_arrays",
    "write_motion",
]
