"""What holds a container in its place, read from logs with force."""
