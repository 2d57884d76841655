"""What follows from models of robots alone, kept on disk for the processes that come after."""
