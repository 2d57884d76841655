"""Lines, arcs and standstill through noisy points: what each would be, and the evidence for it."""
