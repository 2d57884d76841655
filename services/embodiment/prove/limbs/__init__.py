"""Where limbs beside the arm, or its own first ones, are in the way."""
