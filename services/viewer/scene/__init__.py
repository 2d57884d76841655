"""The scene of one person: nodes in a browser; everything that calls viser to draw."""
