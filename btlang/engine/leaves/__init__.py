"""Leaves: the contract for Python objects, and how each kind of them is ticked."""
