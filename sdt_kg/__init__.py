"""Graph and value types of the Semantic Digital Twin; pure: no physics, no network, no clock."""
