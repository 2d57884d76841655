"""A kitchen as a whole: which robot achieves what, and what there is."""
