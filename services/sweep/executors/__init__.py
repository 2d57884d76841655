"""Executors: processes of this machine or a cluster, and work handed out to them a piece at a time."""
