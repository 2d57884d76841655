"""Many worlds: grids of edits, the smallest change that turns a verdict, which robot for which kitchen."""
