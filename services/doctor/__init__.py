"""Is everything there that sdt needs here, and what to do where it is not."""
