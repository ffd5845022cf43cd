"""Writing of changes: a changed syntax tree becomes a changed text. Only what is touched is rewritten, comments
stay.

Each way to write a change, from the smallest to that of a whole statement, is read again: the first one that has
the tree that was meant is taken. So nothing here has to know how sentences are read.
"""

from __future__ import annotations

import re
from bisect import bisect_left
from collections import Counter
from collections.abc import Iterable, Iterator, Mapping, Sequence
from itertools import chain, pairwise

from btlang.diagnostics.diagnostic import MissionError
from btlang.editing.changes import Change, apply_changes
from btlang.editing.lines import Lines, comments_in, indented
from btlang.editing.syntax import ChangeStep, Syntax, Unplaced, are_equal, joined
from btlang.frontends.mission.reader import read_mission
from btlang.passes import lower_mission
from btlang.printer.fragments import MARK, Fragment
from btlang.printer.mission import lines_of, printer_of
from btlang.printer.printer import LOOSE, WHOLE, Doc, Printer, add_brackets
from btlang.printer.sentence import CHAINS, statements
from btlang.text.source import Source
from btlang.text.words import split
from btlang.tree import ast
from btlang.tree.node import Tree

WIDTH = 100
"""Columns; what would be a longer line becomes a block where it can."""
_LONGEST_VALUE = 8  # words
_WAYS = ("as it stands", "in brackets", "anew")
"""How what isn't touched is written within a line that is."""

NO_COMMENTS: Counter[str] = Counter()


class Writer:
    """A writer of changes of one text, in which `syntax` was read.

    `given` are nodes of no text with the words to say them, `copies` new nodes by their identities with the old ones
    whose words they have.
    """

    def __init__(
        self,
        source: Source,
        syntax: Syntax,
        given: Mapping[int, tuple[str, ...]] = {},
        copies: Mapping[int, ast.Ast] = {},
    ) -> None:
        self._source, self._syntax = source, syntax
        self._lines = Lines(source, syntax.nodes, syntax.vocabulary.orthography)
        self._given, self._copies = given, copies
        self._comments = self._comments_in(source.text)
        self._alone: dict[int, bool] = {}

    def written(
        self,
        steps: Sequence[ChangeStep],
        wanted: ast.Program,
        near: ast.Ast | None = None,
        gone: Counter[str] = NO_COMMENTS,
        first: Iterable[Change] = (),
    ) -> Change:
        """Return the change of the text.

        A new definition comes before the statement `near`. The comments `gone` stand elsewhere by now. The changes of
        `first` are tried before all others. Raises Unplaced if no way to write it is read as the mission that is
        `wanted`, or MissionError if none can be read at all.
        """
        tree = lower_mission(wanted, self._syntax.vocabulary)
        kept = self._comments - gone
        tried: set[Change] = set()
        wrong: list[MissionError] = []
        for change in chain(first, self._changes(steps, wanted, near, gone)):
            if change not in tried and self._means(
                apply_changes(self._source.text, [change]), tree, wanted, kept, wrong
            ):
                return change
            tried.add(change)
        if len(wrong) == len(tried) > 0:
            raise wrong[0]
        raise Unplaced("no English says it there")

    def values(self, node: ast.Ast, kind: str, text: str, words: str) -> Iterator[Change]:
        """Yield other words for a value: those of a node that are read as its port text may be the place, fewest first,
        or most where an article has to go, too.
        """
        vocabulary = self._syntax.vocabulary
        found = split(self._source, vocabulary.orthography)
        inside = range(bisect_left(found.starts, node.span.start), bisect_left(found.starts, node.span.end))
        lengths = range(1, _LONGEST_VALUE + 1)
        has_article = words.split()[:1] and words.split()[0].lower() in vocabulary.orthography.articles
        for length in reversed(lengths) if has_article else lengths:
            for first in inside[: len(inside) - length + 1]:
                start, end = found.starts[first], found.ends[first + length - 1]
                if vocabulary.value(kind, self._source.text[start:end]) != text:
                    continue
                starts = [start, found.articles[first][0]] if first in found.articles else [start]
                for each in reversed(starts) if has_article else starts:
                    yield Change(each, end, words)

    def words(self, node: ast.Ast, role: str, other: str) -> list[Change]:
        """Return the words of another role in the place of those of one."""
        vocabulary, text = self._syntax.vocabulary, node.span.text
        phrases = "|".join(re.escape(phrase) for phrase in vocabulary.roles[role])
        found = re.finditer(rf"\b(?:{phrases})\b", text, re.IGNORECASE)
        return [
            Change(node.span.start + match.start(), node.span.start + match.end(), vocabulary.word(other))
            for match in found
        ]

    def comments_of(self, nodes: Iterable[ast.Ast], before: str) -> Counter[str]:
        """Return the comments on the lines of statements and right above them that stand elsewhere, too: they do so
        since the text was as `before`.
        """
        found: Counter[str] = Counter()
        for node in nodes:
            owned = self._lines.own(node, self._syntax.holder(node))
            if owned is not None:
                found += self._comments_in("\n".join(self._lines.texts(self._lines.with_comments(owned))))
        return found & (self._comments - self._comments_in(before))

    def _comments_in(self, text: str) -> Counter[str]:
        return comments_in(text, self._syntax.vocabulary.orthography)

    def _means(
        self, text: str, tree: Tree, wanted: ast.Program, comments: Counter[str], wrong: list[MissionError]
    ) -> bool:
        if comments - self._comments_in(text):
            return False
        vocabulary = self._syntax.vocabulary
        try:
            read = read_mission(self._source.with_text(text), vocabulary).mission
            return read.facts == wanted.facts and are_equal(lower_mission(read, vocabulary), tree)
        except MissionError as error:
            wrong.append(error)
            return False

    # -- ways to write a step

    def _changes(
        self, steps: Sequence[ChangeStep], wanted: ast.Program, near: ast.Ast | None, gone: Counter[str]
    ) -> Iterator[Change]:
        for step in steps:
            for way in _WAYS:
                printer = self._printer(step, wanted, way)
                yield from self._as_lines(step, printer, near, gone)
                yield from self._in_line(step, printer)

    def _printer(self, step: ChangeStep, wanted: ast.Program, way: str) -> Printer:
        """Say what stands in the text, and what is given, in the words that it has there."""
        printer = printer_of(wanted, self._syntax.vocabulary)
        for root in step.new:
            for node in reversed(ast.parents_first(root)):
                if id(node) in self._given:
                    lines = self._given[id(node)]
                    self._keep(node, lines[0] if len(lines) == 1 else "", lines, printer, way)
                elif id(node) in self._copies or id(node) in self._syntax.slots:
                    self._keep_old(node, self._copies.get(id(node), node), printer, way)
                elif isinstance(node, ast.Chain) and node.operator == "sequence":
                    kept = [item for item in node.items if printer.kept_lines(item)]
                    if len(kept) > 1:
                        printer.keep(node, printer.say(node).replace(in_lines=True))
        return printer

    def _keep_old(self, node: ast.Ast, old: ast.Ast, printer: Printer, way: str) -> None:
        around = self._syntax.holder(old)
        if node.span.source is not self._source or way == _WAYS[-1]:
            return
        text = self._lines.text(old)
        if "\n" in text or "#" in text or not self._stands_alone(old, around):
            text = ""
        owned = self._lines.own(old, around)
        lines: Sequence[str] = ()
        if owned is not None:
            lines = self._lines.texts(self._lines.with_comments(owned))
        self._keep(node, text, tuple(lines), printer, way)

    def _keep(self, node: ast.Ast, text: str, lines: tuple[str, ...], printer: Printer, way: str) -> None:
        said = printer.say(node)
        is_block = len(lines) > 1 and not text
        if text:
            said = said.replace(fragments=(Fragment(text, MARK),), in_lines=False)
            if text.startswith("(") and text.endswith(")"):
                said = Doc(said.fragments, WHOLE)
            elif way == "in brackets" and ast.parts(node):
                said = said.replace(level=LOOSE, reaches=True)
        elif not is_block:
            return
        printer.keep(node, said.replace(in_lines=is_block or said.in_lines), lines)

    def _stands_alone(self, node: ast.Ast, around: ast.Ast) -> bool:
        """Return whether the words of a node are its own, and mean the same without those before them."""
        if not isinstance(node, ast.Phrase):
            return True
        if isinstance(around, ast.Chain) and any(node.span == each.span for each in around.items if each is not node):
            return False
        if id(node) not in self._alone:
            vocabulary = self._syntax.vocabulary
            is_condition = node.entry.sort == "condition"
            text = f"{vocabulary.word('check')} {node.span.text}" if is_condition else node.span.text
            places = tuple(fact.name for fact in ast.all_facts(self._syntax.mission))
            try:
                read = read_mission(Source(text), vocabulary.with_places(places) if places else vocabulary).mission.body
            except MissionError:
                read = None
            read = read.condition if isinstance(read, ast.Check) else read
            same = isinstance(read, ast.Phrase) and (read.entry, read.arguments) == (node.entry, node.arguments)
            values = any("{" in text for _, text in node.arguments)  # which only the mission knows
            self._alone[id(node)] = same or values
        return self._alone[id(node)]

    def _as_lines(
        self, step: ChangeStep, printer: Printer, near: ast.Ast | None, gone: Counter[str]
    ) -> Iterator[Change]:
        """Write statements that have lines of their own, as lines."""
        yield from self._in_their_places(step, printer)
        place = self._line_place(step, near, bool(gone))
        if place is None:
            return
        start, end, margin = place
        lines: list[str] = []
        for node in step.new:
            is_block = step.operator == "sequence" and not self._is_kept(node)
            items = statements(node) if is_block else [(node, step.operator)]
            for item, among in items:
                lines += lines_of(item, printer, WIDTH - len(margin), among)
        before, after = self._source.text[:start], self._source.text[end:]
        ends = bool(after) or before.endswith("\n") or self._source.text.endswith("\n")
        text = self._between(step) + indented(lines, margin)
        missing = self._comments_in(self._source.text[start:end]) - self._comments_in(text) - gone
        text = indented(list(missing.elements()), margin) + text
        if before and not before.endswith("\n"):
            yield Change(start, end, "\n" + text.removesuffix("\n"))
        else:
            yield Change(start, end, text if ends else text.removesuffix("\n"))

    def _between(self, step: ChangeStep) -> str:
        """Return the lines of definitions and the like between old statements, for in front of what takes their
        place.
        """
        lines = self._lines
        owned = [each for each in (lines.own(node, step.parent) for node in step.old) if each is not None]
        gaps = [range(one.stop, lines.with_comments(other).start) for one, other in pairwise(owned)]
        said = (gap for gap in gaps if any(line in self._lines.blocks for line in gap))
        return "".join(self._source.text[start:end] for start, end in map(self._lines.offsets, said))

    def _in_their_places(self, step: ChangeStep, printer: Printer) -> Iterator[Change]:
        """Write as many statements as there were, each in the lines of one of these: what stands between them stays."""
        owned = [self._lines.own(node, step.parent) for node in step.old]
        if len(owned) < 2 or len(owned) != len(step.new):
            return
        parts, places = [], []
        for lines, node in zip(owned, step.new, strict=True):
            if lines is None:
                return
            margin = self._lines.margin(lines.start)
            parts.append(indented(lines_of(node, printer, WIDTH - len(margin), step.operator), margin))
            places.append(self._lines.offsets(lines))
        text = self._source.text
        between = [text[end:start] for (_, end), (start, _) in pairwise(places)]
        if not text[: places[-1][1]].endswith("\n"):
            parts[-1] = parts[-1].removesuffix("\n")
        joined = "".join(part + gap for part, gap in zip(parts, [*between, ""], strict=True))
        yield Change(places[0][0], places[-1][1], joined)

    def _is_kept(self, node: ast.Ast) -> bool:
        return id(node) in self._given or id(node) in self._copies or id(node) in self._syntax.slots

    def _line_place(self, step: ChangeStep, near: ast.Ast | None, moved: bool) -> tuple[int, int, str] | None:
        """Return where the lines of a step begin and end in the text, and their margin."""
        lines, around = self._lines, step.parent
        if step.old:
            owned = [lines.own(node, around) for node in step.old]
            first, last = owned[0], owned[-1]
            if first is None or last is None or None in owned:
                return None
            whole = range((lines.with_comments(first) if moved else first).start, last.stop)
            return *lines.offsets(whole), lines.margin(first.start)
        if isinstance(around, ast.Program):
            owned_near = None if near is None else lines.own(near, self._syntax.holder(near))
            line = lines.count + 1 if owned_near is None else lines.with_comments(owned_near).start
            return *lines.offsets(range(line, line)), ""
        if not isinstance(around, ast.Chain) or step.at is None:
            return None
        if step.at and not step.before:
            before = lines.own(around.items[step.at - 1], around)
            if before is None:
                return None
            return *lines.offsets(range(before.stop, before.stop)), lines.margin(before.start)
        behind = lines.own(around.items[step.at], around)
        if behind is None:
            return None
        line = lines.with_comments(behind).start
        return *lines.offsets(range(line, line)), lines.margin(behind.start)

    def _in_line(self, step: ChangeStep, printer: Printer) -> Iterator[Change]:
        """Write parts of a line, within it."""
        items = step.parent.items if isinstance(step.parent, ast.Chain) else ()
        if any(node.span.source is not self._source for node in (*step.old, *items)):
            return
        places = [self._lines.place(item) for item in items]
        if items and step.at is not None and not step.new:
            last = step.at + len(step.old)
            if last < len(items):
                yield Change(places[step.at][0], places[last][0], "")
            if step.at:
                yield Change(places[step.at - 1][1], places[last - 1][1], "")
            return
        if not step.new or not (step.old or items):
            return
        for said in self._is_said_in_line(step.new, step.operator, printer):
            if step.old:
                yield Change(self._lines.place(step.old[0])[0], self._lines.place(step.old[-1])[1], said)
                continue
            assert step.at is not None
            for joint in self._joints(places, step.operator, printer):
                if step.at:
                    end = places[step.at - 1][1]
                    yield Change(end, end, joint + said)
                if step.at < len(items):
                    start = places[step.at][0]
                    yield Change(start, start, said + joint)

    def _is_said_in_line(self, nodes: Sequence[ast.Ast], operator: str, printer: Printer) -> Iterator[str]:
        said = printer.say(joined(nodes, operator))
        if said.in_lines:
            return
        yield printer.text(said.fragments)
        if said.level < WHOLE:
            yield printer.text(add_brackets(said).fragments)

    def _joints(self, places: Sequence[tuple[int, int]], operator: str, printer: Printer) -> Iterator[str]:
        """Return what stands between the items of a chain, the usual word last."""
        between = [self._source.text[end:start] for (_, end), (start, _) in pairwise(places) if end <= start]
        yield from dict.fromkeys(each for each in reversed(between) if "\n" not in each and "#" not in each)
        yield f" {printer.word(CHAINS[operator][1]).text} "
