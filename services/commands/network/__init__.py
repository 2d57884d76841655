"""Services: HTTP, Zenoh, tools for agents."""
