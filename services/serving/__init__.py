"""All services together, on one World: HTTP, Zenoh, the 3D page."""
