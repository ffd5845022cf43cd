"""Texts to trees: English by way of a syntax tree, XML and JSON at once. `table.py` lists them."""
