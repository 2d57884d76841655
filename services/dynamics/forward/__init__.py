"""Forward dynamics: where a container goes under forces at its handle."""
