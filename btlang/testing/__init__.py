"""Tests of missions in English: `btc test` runs them on the simulated robot."""
