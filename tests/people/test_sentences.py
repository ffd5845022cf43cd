"""What becomes of the sentences: how many are read as people mean them, and what the others get.

`read.out` has a line for each: `right`, `warned` (right, with the warning that it deserves), `refused`, `message`
with its code, or `other` where the tree is another one. No sentence may be read otherwise without a warning, but
for those that `SILENT` lists, which are still to be warned about.
"""

from __future__ import annotations

from functools import cache

import pytest

from btlang.diagnostics.diagnostic import MissionError
from btlang.tree.node import Node
from tests.conftest import matches_golden
from tests.people.notation import FOLDER, Sample, compiled, parsed, samples, written

SILENT: set[str] = set()
"""Read otherwise than people mean, in silence."""
LEAST = 230
"""So many are right; it only grows."""
SAMPLES = samples()


def flat(node: Node) -> Node:
    """Sequences in sequences as one: nobody means a difference."""
    children = [flat(child) for child in node.children]
    if node.id == "Sequence":
        inner = [part.children if part.id == "Sequence" and not part.ports else (part,) for part in children]
        children = [one for part in inner for one in part]
    return node.replace(children=tuple(children), span=None)


def shape(notation: str) -> object:
    tree = parsed(notation)
    return flat(tree.root), [(name, flat(root)) for name, root in sorted(tree.subtrees)]


@cache
def outcome(sample: Sample) -> str:
    try:
        mission = compiled(sample.text)
    except MissionError as error:
        codes = sorted({problem.code for problem in error.diagnostics if problem.is_error})
        return "refused" if sample.refused else f"message {' '.join(codes)}"
    if sample.refused:
        return "read"
    if shape(written(mission.tree)) == shape(sample.tree):
        return "warned" if sample.warned and mission.warnings else "right"
    return "other, warned" if mission.warnings else "other"


def test_what_becomes_of_each() -> None:
    lines = [f"{sample.place} {outcome(sample)}\n" for sample in SAMPLES]
    matches_golden("".join(lines), FOLDER / "read.out")


def test_what_must_be_refused_is() -> None:
    assert [sample.place for sample in SAMPLES if outcome(sample) == "read"] == []


def test_what_is_offered_instead_can_be_pasted() -> None:
    """The tree of the sample is that of the sentence which the message offers, but for prohibitions."""
    for sample in SAMPLES:
        for offered in sample.proposals:
            compiled(offered)
            if outcome(sample) in ("right", "other, warned") or sample.place == "waiter.txt:98":  # a part is offered
                continue
            with pytest.raises(MissionError) as raised:
                compiled(sample.text)
            assert offered.lower().rstrip(".") in str(raised.value).lower(), sample.place


def test_none_is_read_otherwise_in_silence() -> None:
    assert {sample.place for sample in SAMPLES if outcome(sample) == "other"} <= SILENT


def test_so_many_are_right() -> None:
    assert sum(outcome(sample) in ("right", "warned") for sample in SAMPLES) >= LEAST
