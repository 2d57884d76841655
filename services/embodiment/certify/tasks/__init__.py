"""What rules and qualities of task specifications ask of a body motion."""
