"""Task specifications: steps, rules that hold along the way, and what a good motion is."""
