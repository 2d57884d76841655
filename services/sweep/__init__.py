"""Many cases: planned from a grid, a table or a query, judged by any executor, kept as they are done."""
