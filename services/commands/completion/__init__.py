"""Completion in the shell: commands, options, and names as the twin has them."""
