"""A walk through the four usage modes on kitchen B, with commands that really run."""
