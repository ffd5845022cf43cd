"""What differs between two missions, trees or recorded runs: the verb `diff`."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable, Iterator, Sequence
from contextlib import ExitStack, suppress
from difflib import SequenceMatcher
from itertools import zip_longest
from operator import itemgetter

from btlang.api import Mission, parse_file
from btlang.backends.tree_diff import find_differences
from btlang.diagnostics.diagnostic import MissionError
from btlang.engine.status import NAMES
from btlang.recording.reader import is_recording, open_recording
from btlang.recording.story import Story
from btlang.run.events import Event, StatusesChanged
from btlang.text.output import show
from btlang.tree.catalogue import SUBTREE
from btlang.tree.node import Node, Tree
from btlang.tree.visit import children_first

TYPE_CHECKING = False
if TYPE_CHECKING:
    import argparse
    from typing import TypeAlias, TypeVar

    Item = TypeVar("Item")

    Step: TypeAlias = tuple[float, int, int, str]

    """When, the number of a node, its new status, and why it failed."""

    Pair: TypeAlias = tuple[Step | None, Step | None]

    """A step of each of two runs, None where a run has no more."""


def steps(events: Iterable[Event]) -> Iterator[Step]:
    """Yield all changes of statuses."""
    for event in events:
        if isinstance(event, StatusesChanged):
            for index, status, _, reason in event.without_paths():
                yield event.t, index, status, reason


def first_difference(
    one: Iterable[Event], other: Iterable[Event], node: Callable[[int], Node], label: Callable[[Node], str]
) -> str:
    """Return the first change of status in which two runs differ, in words; "" if there is none. Times don't count."""
    pair = first_pair(one, other)
    if pair is None:
        return ""
    before, now = (describe_step(step, node, label) for step in pair)
    return f"before: {before}\nnow:    {now}"


def first_pair(one: Iterable[Event], other: Iterable[Event]) -> Pair | None:
    """Return the first changes of status in which two runs differ, None if there are none. Times don't count."""
    for first, second in zip_longest(steps(one), steps(other)):
        if first is None or second is None or first[1:] != second[1:]:
            return first, second
    return None


def describe_step(step: Step | None, node: Callable[[int], Node], label: Callable[[Node], str]) -> str:
    """Return a step in words."""
    if step is None:
        return "nothing more"
    t, index, status, reason = step
    return f"at {t:.2f} s  {label(node(index))}: {NAMES[status]}{f' ({reason})' if reason else ''}"


def compare_endings(one: Iterable[Event], other: Iterable[Event]) -> list[int]:
    """Return the numbers of the nodes whose last status isn't the same; one that never began has none."""
    last = [{index: status for _, index, status, _ in steps(events)} for events in (one, other)]
    return sorted(index for index in last[0].keys() | last[1].keys() if last[0].get(index) != last[1].get(index))


def run_differences(one: Iterable[str], other: Iterable[str]) -> Iterator[str]:
    """Yield what only one of the stories of two runs has, whenever it was: `-` the first one, `+` the second."""
    lines = [[_split(line) for text in story for line in text.splitlines()] for story in (one, other)]
    for which, (time, words) in only_in_one(lines[0], lines[1], itemgetter(1)):
        yield f"{'-+'[which]} {time}{words}"


def only_in_one(
    one: Sequence[Item], other: Sequence[Item], key: Callable[[Item], object]
) -> Iterator[tuple[int, Item]]:
    """Yield what only one of two lists has, by this key, with the number of the list, in the order of both."""
    sides = one, other
    keys = [[key(item) for item in side] for side in sides]
    for tag, *bounds in SequenceMatcher(a=keys[0], b=keys[1], autojunk=False).get_opcodes():
        if tag != "equal":
            for which, side in enumerate(sides):
                first, last = bounds[2 * which : 2 * which + 2]
                yield from ((which, item) for item in side[first:last])


def _split(line: str) -> tuple[str, str]:
    """Return the time at the start of a line of a story, and the rest."""
    match = re.match(r" *[\d.]+ s  ", line)
    return (match[0].strip() + "  ", line[match.end() :]) if match else ("", re.sub(r" after [\d.]+ s", "", line))


_LONGEST = 80  # characters of the words of a node


def diff(options: argparse.Namespace) -> int:
    """Print a line for each difference; return 1 where there is one. Raises MissionError for what can't be read."""
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
    """Return a line for each difference of their trees."""
    return find_differences(old.tree, new.tree, words_of(old), words_of(new))


def words_of(mission: Mission) -> Callable[[Node], str]:
    """Return the English of a node in one line, of a long one that of its first and last command."""

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
        sides = [stack.enter_context(open_recording(path)) for path in (options.old, options.new)]
        stories = [Story(mission, nodes, {}).take(recording.events(nodes)) for recording, mission, nodes in sides]
        yield from run_differences(*(story.body() for story in stories))
