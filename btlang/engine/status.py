"""Statuses of BehaviorTree.CPP. SUCCESS and FAILURE are True and False: the answer of a function leaf is its status."""

from __future__ import annotations

FAILURE: int = False
SUCCESS: int = True
RUNNING = 2
SKIPPED = 3
IDLE = 4

NAMES = ("FAILURE", "SUCCESS", "RUNNING", "SKIPPED", "IDLE")
