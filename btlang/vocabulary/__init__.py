"""Keyword files and what they become: phrases, slot types with units, connectives, and the trie that finds them."""
