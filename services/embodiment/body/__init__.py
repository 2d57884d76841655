"""A robot as planning moves it: limbs, inverse kinematics, collision checks."""
