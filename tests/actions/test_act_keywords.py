"""The shipped keyword files: every entry can be called with its slots, and its example means it."""

from importlib import import_module
from inspect import isgeneratorfunction, signature

import pytest

from btlang.robots.worlds.world_file import world_names
from btlang.text.source import Source
from btlang.text.words import split
from btlang.vocabulary.entry import COMPARISONS
from btlang.vocabulary.load import load_vocabulary
from btlang.vocabulary.trie import longest

NAMES = world_names()
VOCABULARY = load_vocabulary((), NAMES.by_type)
ENTRIES = [entry for entries in VOCABULARY.entries.values() for entry in entries if entry.call]  # not further phrases


def meaning(text):
    words = split(Source(text), VOCABULARY.orthography)
    match = longest(VOCABULARY.trie, words, 0, VOCABULARY.context)
    return match.meaning.entry.id, {value.name: value.text for value in match.values}


@pytest.mark.parametrize("entry", ENTRIES, ids=lambda entry: entry.id)
def test_entries(entry):
    module, _, name = entry.call.partition(":")
    call = getattr(import_module(module), name)
    parameters = signature(call).parameters
    further = {name for name, parameter in parameters.items() if parameter.kind is parameter.VAR_KEYWORD}
    ports = set(parameters) - further - {"robot", "clock", "blackboard", "progress", "kept"}
    slots = [slot for slot in entry.slots if not entry.measures or slot.name not in COMPARISONS]
    assert ports <= {slot.name for slot in slots}
    assert further or ports == {slot.name for slot in slots}
    said_always = [slot for slot in slots if all(f"{{{slot.name}}}" in phrase for phrase in entry.phrases)]
    for slot in slots:
        if slot.name not in ports:
            continue
        optional = parameters[slot.name].default is None or slot.default is not None
        assert optional or slot in said_always
    assert call.__doc__
    assert entry.help.endswith(".")
    assert not entry.phrases or meaning(entry.example)[0] == entry.id
    if entry.sort == "condition":
        assert not isgeneratorfunction(call)
        assert not entry.resources


@pytest.mark.parametrize(
    ("text", "node", "ports"),
    [
        ("move forward", "MoveForward", {}),
        ("drive straight ahead 2 m at 0.3 m/s", "MoveForward", {"distance": "2", "speed": "0.3"}),
        ("go forward by half a meter", "MoveForward", {"distance": "0.5"}),
        ("drive back at 0.2 m/s", "MoveBackward", {"speed": "0.2"}),
        ("turn 45 degrees to the left", "TurnLeft", {"angle": "45"}),
        ("spin right by 10 degrees", "TurnRight", {"angle": "10"}),
        ("twist right", "TurnRight", {}),
        ("go to the lab", "GoTo", {"place": "lab"}),
        ("come back to Alice", "GoToPerson", {"person": "Alice"}),
        ("approach the red ball", "Approach", {"object": "red ball"}),
        ("there is a wall ahead", "WallInFront", {}),
        ("an obstacle ahead", "WallInFront", {}),
        ("the wall is in front of the robot", "WallInFront", {}),
        ("there is a wall on the left", "WallOnLeft", {}),
        ("the way is free", "PathClear", {}),
        ("the robot is in the kitchen", "InZone", {"zone": "kitchen"}),
        ("pick the red ball up", "PickUp", {"object": "red ball"}),
        ("lift the arm", "RaiseArm", {}),
        ("open the left gripper", "OpenLeftHand", {}),
        ("wave to Bob", "Wave", {"person": "Bob"}),
        ("recharge the battery to 80%", "Charge", {"percent": "80"}),
    ],
)
def test_meanings(text, node, ports):
    assert meaning(text) == (node, ports)
