"""Texts: sources and places in them, words, spelling suggestions, TOML, and output to terminals."""
