"""The Law over Zenoh: keys, messages, server, client."""
