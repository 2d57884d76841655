"""A first annotation for a robot of one's own, its guesses completed by looking: pairs and parked posture."""
