"""Robots of other computers, which join a server."""
