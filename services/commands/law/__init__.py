"""The Law and its predicates: one task, a table, a sequence, another world, something seen."""
