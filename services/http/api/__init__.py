"""JSON verbs under `/api/v1`."""
