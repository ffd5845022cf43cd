"""Leaves that do the same in py_trees and here."""

from __future__ import annotations

from itertools import cycle

from py_trees.behaviour import Behaviour
from py_trees.common import Status

from btlang.tree.node import Node

from .scripted import STATUS, World

STATUSES = {"r": Status.RUNNING, "s": Status.SUCCESS, "f": Status.FAILURE}
LETTERS = {status: letter for letter, status in STATUSES.items()}


class Script:
    """What a leaf returns: each run takes the next of some words, each call in it the next letter."""

    def __init__(self, id: str, words: str, log: list[str]) -> None:
        self.id, self.log = id, log
        self.is_function = id.startswith("F")
        self.words = cycle(words.split(","))
        self.letters = iter("")

    def call(self, step: str) -> str:
        if self.is_function:
            self.log.append(self.id)
            return next(self.words)
        self.log.append(f"{self.id}.{step}")
        if step == "start":
            self.letters = iter(next(self.words))
        return next(self.letters)


class TheirLeaf(Behaviour):
    """A behaviour that is halted where it is stopped while RUNNING; py_trees stops what has completed as well."""

    def __init__(self, script: Script) -> None:
        super().__init__(script.id)
        self.script = script
        self.step = ""

    def initialise(self) -> None:
        self.step = "start"

    def update(self) -> Status:
        letter = self.script.call(self.step)
        self.step = "tick"
        return STATUSES[letter]

    def terminate(self, new_status: Status) -> None:
        if self.status == Status.RUNNING and new_status == Status.INVALID and not self.script.is_function:
            self.script.log.append(f"{self.name}.halt")


def bind(world: World, id: str, words: str) -> Node:
    """Our leaf: a function where the id begins with F, else a class."""
    script = Script(id, words, world.log)
    if script.is_function:
        return world.bind(id, lambda: STATUS[script.call("")])

    class Leaf:
        def start(self) -> int:
            return STATUS[script.call("start")]

        def tick(self) -> int:
            return STATUS[script.call("tick")]

        def halt(self) -> None:
            world.log.append(f"{id}.halt")

    return world.bind(id, Leaf)
