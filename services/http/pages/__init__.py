"""Pages for people, rendered here: every view has its state in its URL, and its data as JSON and CSV."""
