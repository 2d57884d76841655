"""What comes in from a browser, and what of it is let in."""
