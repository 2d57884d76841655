"""Results of task specifications: as values, as triples, and read from a store again."""
