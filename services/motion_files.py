"""Where motions in files were; see `services.motions`."""

from services.motions import arrays_of, motion_of, read_motion, write_motion

__all__ = ["arrays_of", "motion_of", "read_motion", "write_motion"]
