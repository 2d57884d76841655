"""Where a moving part of the kitchen is stopped: by the floor and by other parts, but for what bears it."""
