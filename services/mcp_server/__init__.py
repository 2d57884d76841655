"""The Law as tools for agents that speak MCP: look up, ask, have a motion verified, read why, repair."""
