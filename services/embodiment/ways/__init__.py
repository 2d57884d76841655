"""Ways to a holding: roads among the furniture, the arm's way, time laws."""
