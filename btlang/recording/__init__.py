"""Recordings of runs in MCAP files, and what is made of them later."""
