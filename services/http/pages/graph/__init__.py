"""What the graph says: one resource, any query, and the vocabulary."""
