"""Worlds around robots: what world files describe, what a robot knows of one, and ways through it."""
