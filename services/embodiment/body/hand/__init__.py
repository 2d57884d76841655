"""A hand without its arm, in compiled loops."""
