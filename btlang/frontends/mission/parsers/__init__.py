"""Grouped tokens to the syntax tree, in two ways that give the same."""
