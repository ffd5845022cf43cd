"""Missions in English to syntax trees, in rooms; ARCHITECTURE.md has the order."""
