"""What a service says of itself: counts, logs, spans. Nothing of it leaves the machine."""
