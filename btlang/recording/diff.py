"""What `btc diff` does: two missions, trees or recorded runs, and what differs between them."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import ExitStack, suppress

from btlang.api import Mission, parse_file
from btlang.backends.tree_diff import differences
from btlang.diagnostics.errors import MissionError
from btlang.recording.compare import run_differences
from btlang.recording.open import is_recording, opened
from btlang.recording.story import Story
from btlang.text.output import show
from btlang.tree.catalogue import SUBTREE
from btlang.tree.node import Node, Tree
from btlang.tree.visit import children_first

TYPE_CHECKING = False
if TYPE_CHECKING:
    import argparse

_LONGEST = 80  # characters of the words of a node


def diff(options: argparse.Namespace) -> int:
    """Prints a line for each difference; returns 1 where there is one. Raises MissionError for what can't be read."""
    found = list(_of_runs(options) if is_recording(options.old) and is_recording(options.new) else _of_trees(options))
    if options.markdown:
        show("\n".join(f"- {line}" for line in found) if found else "No differences.")
    else:
        show("\n".join(found) if found else "No differences.")
    return 1 if found else 0


def _of_trees(options: argparse.Namespace) -> Iterator[str]:
    old, new = (
        parse_file(path, keywords=options.keywords, world=options.world, language=options.language)
        for path in (options.old, options.new)
    )
    return mission_differences(old, new)


def mission_differences(old: Mission, new: Mission) -> Iterator[str]:
    """A line for each difference of their trees."""
    return differences(old.tree, new.tree, words_of(old), words_of(new))


def words_of(mission: Mission) -> Callable[[Node], str]:
    """The English of a node in one line, of a long one that of its first and last command."""

    def said(node: Node) -> str:
        below = children_first(node)
        leaves = [mission.label(each) for each in below if not each.children]
        if len(leaves) == 1 == len(below):
            return leaves[0]
        text = ""
        if all(each.id != SUBTREE for each in below):  # what names stand for would be said with it
            with suppress(MissionError):
                text = str(mission.replace(tree=Tree(node), syntax=None).to("english")).strip()
        lines = text.splitlines()
        if lines and not any(line.endswith(":") for line in lines):  # no blocks
            text = f" {mission.vocabulary.word('then')} ".join(lines)
            if len(text) <= _LONGEST:
                return text
        return leaves[0] if len(leaves) == 1 else f"{leaves[0]} ... {leaves[-1]}"

    return said


def _of_runs(options: argparse.Namespace) -> Iterator[str]:
    with ExitStack() as stack:
        sides = [stack.enter_context(opened(path)) for path in (options.old, options.new)]
        stories = [Story(mission, nodes, {}).take(recording.events(nodes)) for recording, mission, nodes in sides]
        yield from run_differences(*(story.body() for story in stories))
