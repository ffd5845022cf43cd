"""Grammars of the missions of a vocabulary, for language models whose output is constrained by one."""
