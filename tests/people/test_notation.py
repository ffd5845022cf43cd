"""The samples are well formed: their trees are in the notation, of nodes and values that are known."""

from __future__ import annotations

import pytest

from btlang.robots.mission_vocabulary import world_vocabulary
from btlang.tree.catalogue import CATALOGUE
from btlang.tree.node import Node, Tree
from tests.people.notation import FOLDER, PACK, WORLD, Sample, compiled, parsed, samples, written
from tests.profiles import each_of

NEW: dict[str, set[str]] = {
    "Choose": {"how", "output", "type"},
    "WaitForTime": {"time"},
    "TimeOfDay": {"above", "at_least", "at_most", "below"},
    "GoTo": {"place", "x", "y", "facing"},
}
"""Nodes and ports of sentences that the language doesn't read yet."""
SAMPLES = samples()
MEANT = [sample for sample in SAMPLES if not sample.refused]


def test_there_are_enough_of_each_kind() -> None:
    files = {path.name for path in FOLDER.glob("*.txt")}
    assert [file for file in files if sum(sample.file == file for sample in SAMPLES) < 25] == []
    assert len(SAMPLES) >= 200
    assert len({sample.text for sample in SAMPLES}) == len(SAMPLES)
    assert sum(sample.refused or sample.warned for sample in SAMPLES) >= 10


@each_of([(sample.place, sample) for sample in MEANT], at_a_time=50)
def test_trees_are_in_the_notation(place: str, sample: Sample) -> None:
    assert written(parsed(sample.tree)) == sample.tree


@each_of([(sample.place, sample) for sample in MEANT], at_a_time=50)
def test_nodes_and_values_are_known(place: str, sample: Sample) -> None:
    tree, vocabulary = parsed(sample.tree), world_vocabulary([PACK], WORLD)
    names = {name for name, _ in tree.subtrees}
    for node in tree.walk():
        entry, kind = vocabulary.entry(node.id), CATALOGUE.get(node.id)
        assert entry or kind or node.id in NEW, node.id
        slots = {slot.name: slot.type for slot in entry.slots} if entry else {}
        known = {*slots, *(kind.ports if kind else ()), *NEW.get(node.id, ()), "_skipIf"}
        if node.id == "SubTree":
            assert node.port("ID") in names
        else:
            assert {key for key, _ in node.ports} <= known, node.id
        named = [(slots[key], text) for key, text in node.ports if slots.get(key) in ("place", "person", "object")]
        assert [text for type, text in named if text[0] != "{" and vocabulary.value(type, text) != text] == []


@pytest.mark.parametrize("sample", [sample for sample in SAMPLES if sample.proposals], ids=lambda sample: sample.place)
def test_proposals_compile(sample: Sample) -> None:
    for proposal in sample.proposals:
        assert compiled(proposal).tree.root.children


COMPILED = [
    ("Go to the kitchen.\nBring the tea to Alice.", "S(GoTo place=kitchen, Bring object=tea person=Alice)"),
    (
        'if someone is near, say "Hi, you (two)"',
        'IfThenElse(SomeoneNear, Say text="Hi, you (two)", AlwaysSuccess _skipIf=true)',
    ),
    ("greet is wave and say hello; greet or nod", "F(SubTree ID=greet, Nod)\ngreet := P(Wave, Say text=hello)"),
    ("dock provided that the battery is low", "RS(BatteryLow, Dock)"),
    ("sing for 5 s", "P failure_count=1 success_count=1(Sleep msec=5000, Repeat num_cycles=-1(Sing))"),
]


@pytest.mark.parametrize(("text", "tree"), COMPILED)
def test_notation_of_compiled_trees(text: str, tree: str) -> None:
    assert written(compiled(text).tree) == tree
    assert written(parsed(tree)) == tree


def test_text_that_would_end_a_value_is_quoted() -> None:
    tree = Tree(Node("Say", ports=(("text", 'a "b"\\\n'),)))
    assert written(tree) == r'Say text="a \"b\"\\\n"'
    assert parsed(written(tree)) == tree


@pytest.mark.parametrize("text", ["", "S(", "S(Wave", "S()", "S(Wave,Nod)", "S(Wave))", "Say text=", "Wave\ngreet Nod"])
def test_other_texts_are_no_trees(text: str) -> None:
    with pytest.raises(ValueError, match=r"."):
        parsed(text)
