"""Statuses of BehaviorTree.CPP, as integers: comparing them is what a tick does most."""

from __future__ import annotations

IDLE = 0
RUNNING = 1
SUCCESS = 2
FAILURE = 3
SKIPPED = 4

NAMES = ("IDLE", "RUNNING", "SUCCESS", "FAILURE", "SKIPPED")
