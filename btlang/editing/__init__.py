"""Editing: what an editor asks of a text, namely its tree, help, completions and names, and changes by the tree."""
