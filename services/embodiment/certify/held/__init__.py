"""Whether a gripper has the handle between its fingers, and keeps it."""
