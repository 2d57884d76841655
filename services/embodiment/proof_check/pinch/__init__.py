"""Both fingers at the handle: how high each of them comes, in the posture that the other one needs."""
