"""The subcommands of `sdt`, one module for each family."""
