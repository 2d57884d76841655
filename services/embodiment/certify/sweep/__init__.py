"""Bodies along the motion, between samples too: pieces, kinematics, shapes, distances."""
