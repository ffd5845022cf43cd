"""The printer of syntax trees: words of the vocabulary, values and brackets, which every form needs."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Set

from btlang.printer.fragments import (
    CLOSE,
    LEAF,
    OPEN,
    WORD,
    Fragment,
    Fragments,
    flatten,
    join_fragments,
    last_fragment,
    mark,
    reads_on,
)
from btlang.printer.phrase import holds_definer, leaf_words, value_of
from btlang.support.record import Record
from btlang.tree import ast
from btlang.tree.conjunctions import Conjunctions
from btlang.tree.visit import fold
from btlang.vocabulary.entry import Meaning
from btlang.vocabulary.lexicon import Lexicon
from btlang.vocabulary.pattern import Form, Slot, forms, name_form
from btlang.vocabulary.trie import TrieNode, add

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any, TypeAlias

    SayNode: TypeAlias = Callable[[Any, list["Doc"], "Printer"], "Doc"]

LOOSE, THEN, OR, AND, FORM, WHOLE = range(6)
"""How tightly what is said holds together, loosest first; WHOLE is a leaf or stands in brackets."""


class Doc(Record):
    """The English of a node, and what may not stand around it without brackets.

    `reaches`: what follows it would become part of it. `takes_otherwise`: an `otherwise` right behind it would.
    `counts`: a count in it would close a `try` or `retry` before it. `behind`: it is a form behind its body.
    `in_lines`: it holds a standing rule, which no bracket can, so that it is said in lines and blocks only (see
    mission.py). `joins` and `chooses`: it holds `then` or `and`, `or` or `otherwise` between commands.
    `can_skip`: it may end SKIPPED.
    """

    fragments: Fragments
    level: int
    reaches: bool = False
    takes_otherwise: bool = False
    counts: bool = False
    behind: bool = False
    in_lines: bool = False
    joins: bool = False
    chooses: bool = False
    can_skip: bool = False

    @property
    def is_mixed(self) -> bool:
        """Whether people read it in one line in more ways than one, whatever the brackets."""
        return self.joins and self.chooses


class Printer:
    """A printer of nodes in the words of a vocabulary, where `names` are defined; `printers` print each kind of
    node.

    With `brackets` "all" each chain and form inside another one is bracketed, with "needed" only those whose reading
    needs it (see the table in docs/language/grouping.md): what binds less tightly than what is around it,
    a chain in an equal chain, and a form that reaches to the right where something follows it. With "clear" there
    are also those without which people could read it in another way, and blocks where even these are too hard to read.
    `untyped` are the keys of values that are of any type.
    """

    def __init__(
        self,
        printers: Mapping[type[ast.Ast], SayNode],
        vocabulary: Lexicon,
        names: Iterable[str | ast.Definition] = (),
        brackets: str = "needed",
        untyped: Set[str] = frozenset(),
    ) -> None:
        self._printers = printers
        if brackets not in ("needed", "clear", "all"):
            raise ValueError(f'brackets are "needed", "clear" or "all": {brackets!r}')
        self.vocabulary = vocabulary.with_references()
        self.vocabulary.context.untyped = untyped
        self.all_brackets = brackets == "all"
        self.is_clear = brackets == "clear"
        self.names: TrieNode = {}
        self.subtrees: set[str] = set()
        """The names in quotes."""
        self._said: dict[int, tuple[ast.Ast, Doc]] = {}  # with its node, so that no other one gets its id
        self._forms: dict[str, Form] = {}
        self._leaves: dict[tuple[str, tuple[tuple[str, str], ...]], str] = {}
        self._reads_on: dict[tuple[Fragment, Fragment], bool] = {}
        self._parameters: dict[str, dict[str, str]] = {}
        self._comments: dict[int, tuple[ast.Ast, tuple[str, ...]]] = {}  # with its node, too
        self._kept: dict[int, tuple[ast.Ast, tuple[str, ...]]] = {}
        bodies: dict[str, ast.Ast] = {}
        self._conjunctions = Conjunctions(bodies, vocabulary)
        for defined in names:
            if isinstance(defined, ast.Definition):
                bodies[defined.name] = defined.body
            name, types = (
                (defined.name, dict(defined.parameters)) if isinstance(defined, ast.Definition) else (defined, {})
            )
            self._parameters[name] = types
            if isinstance(defined, ast.Definition) and defined.is_quoted:
                self.subtrees.add(name)
            else:
                add(self.names, name_form(name), types, Meaning("name"))

    def say(self, node: ast.Ast) -> Doc:
        """Print a node (any but a Mission)."""
        if id(node) in self._said:
            return self._said[id(node)][1]

        def combine(item: ast.Ast, parts: list[Doc]) -> Doc:
            if id(item) in self._kept:
                return self._said[id(item)][1]
            said: Doc = self._printers[type(item)](item, parts, self)
            if any(part.in_lines for part in parts) or any(isinstance(part, ast.Whenever) for part in ast.parts(item)):
                said = said.replace(in_lines=True)
            if parts or isinstance(item, ast.Name):
                said = _with_flags(item, said, parts)
            self._said[id(item)] = item, said
            return said

        return fold(node, ast.parts, combine)

    def keep(self, node: ast.Ast, said: Doc, lines: tuple[str, ...] = ()) -> None:
        """Say a node in these words from now on, such as those of a text; as a statement in `lines`, if there are
        any.

        Nothing of what holds it may have been said before.
        """
        self._said[id(node)] = node, said
        self._kept[id(node)] = node, lines

    def kept_lines(self, node: ast.Ast) -> tuple[str, ...]:
        """Return the lines that `keep` got."""
        return self._kept.get(id(node), (node, ()))[1]

    def statement(self, node: ast.Ast, joined: str = "") -> str:
        """Print a separate line, or one of several that make a chain of the operator `joined`."""
        return self.line(node, self.say(node), joined)

    def line(self, node: ast.Ast, said: Doc, joined: str) -> str:
        """Print a statement as `statement` does, of what is said of the node."""
        if isinstance(node, ast.Chain) and node.operator == joined:
            said = add_brackets(said)
        text = self.text(said.fragments)
        if not isinstance(node, ast.Definition) and self._would_define(flatten(said.fragments)):
            return f"{self.vocabulary.word('then')} {text}"  # a line that begins so defines nothing
        return text

    def _would_define(self, fragments: Iterable[Fragment]) -> bool:
        """Whether a word that defines stands in a command or name; in a condition it compares."""
        return any(fragment.kind == LEAF and holds_definer(fragment.text, self.vocabulary) for fragment in fragments)

    def text(self, fragments: Fragments) -> str:
        """Join fragments to a text."""
        return join_fragments(fragments, self.vocabulary, self.names)

    # -- comments

    def note(self, node: ast.Ast, lines: tuple[str, ...]) -> None:
        """Put lines of comment before the statement in which a node is said."""
        before = self._comments.get(id(node), (node, ()))[1]
        self._comments[id(node)] = node, (*lines, *before)

    def comments(self, node: ast.Ast, *, whole: bool) -> list[str]:
        """Return the comments of a statement; of a block, which isn't `whole`, without those of the lines below."""
        if not self._comments:
            return []
        found: list[str] = []
        stack = [node]
        while stack:
            item = stack.pop()
            found += self._comments[id(item)][1] if id(item) in self._comments else ()
            if whole or item is not node:
                stack += reversed(ast.parts(item))
            elif "condition" in item.parts:
                stack.append(item.condition)  # type: ignore[attr-defined]
        return found

    # -- words

    def word(self, role: str, **values: str) -> Fragment:
        """Return the word of a role, with the value of its slot: `then`, `within 5 s`."""
        if role not in self._forms:
            self._forms[role] = forms(self.vocabulary.first(role))[-1]
        words = (values[part.name] if isinstance(part, Slot) else part for part in self._forms[role])
        return Fragment(" ".join(words), WORD)

    def phrase(self, node_id: str, arguments: tuple[tuple[str, str], ...]) -> str:
        """Return the phrase of a leaf, "" if there is none."""
        key = node_id, arguments
        if key not in self._leaves:
            self._leaves[key] = leaf_words(node_id, dict(arguments), self.vocabulary, self.names)
        return self._leaves[key]

    def value(self, text: str, kind: str) -> str:
        """Return a port text of a type as it is written."""
        return value_of(text, self.vocabulary.types[kind], self.vocabulary)

    def plain_value(self, text: str, kind: str) -> str:
        """Print a value if no slot gives the type: a text is in quotes, as a bare word may be a name or a number."""
        value = self.value(text, kind)
        if kind != "text" or value != text or value.startswith("{"):
            return value
        return f'"{value}"'

    def name(self, node: ast.Name) -> str:
        """Return a defined name with its arguments."""
        types, arguments = self._parameters.get(node.name, {}), dict(node.arguments)
        parts = name_form(node.name)
        return " ".join(
            self.value(arguments[part.name], types.get(part.name, "text")) if isinstance(part, Slot) else part
            for part in parts
        )

    def duration(self, role: str, seconds: str) -> Fragment:
        """Return the word of a role that has a duration."""
        return self.word(role, duration=self.value(seconds, "duration"))

    def time_of_day(self, role: str, time: str) -> Fragment:
        """Return the word of a role that has a time of day."""
        return self.word(role, time_of_day=self.value(time, "time_of_day"))

    def rounds(self, number: str) -> Fragment:
        """Print `3 times`; one word for once and for a number without end."""
        single = [word for word, rounds in self.vocabulary.counts.items() if str(rounds) == number]
        if single and number in ("-1", "1"):
            return Fragment(single[0], WORD)
        return self.word("once") if number == "1" else self.word("count", count=number)

    # -- brackets

    def inside(self, said: Doc, needs_brackets: bool) -> Doc:
        """Print something inside another chain or form."""
        if said.level < WHOLE and (needs_brackets or self.all_brackets):
            return add_brackets(said)
        return said

    def joined_by_and(self, node: ast.Chain) -> bool:
        """Whether `and` alone says that the parts of a parallel run at the same time."""
        means_otherwise = self.vocabulary.first("and") in self.vocabulary.meanings
        return not means_otherwise and self._conjunctions.are_simultaneous(node.items)

    def condition(self, said: Doc) -> Doc:
        """Print the condition of a form: no reading needs brackets round it."""
        return add_brackets(said) if self.all_brackets and said.level < FORM else said

    def reads_on(self, said: Doc, fragment: Fragment) -> bool:
        """Whether the end of what is said and a connective behind it would be read as one."""
        key = last_fragment(said.fragments), fragment
        if key not in self._reads_on:
            self._reads_on[key] = reads_on(*key, self.vocabulary, self.names)
        return self._reads_on[key]

    def behind(self, body: Doc, word: Fragment, *rest: Fragments, counts: bool = False) -> Doc:
        """Print a form that stands behind its body."""
        body = self.inside(body, body.level < FORM or body.reaches or self.reads_on(body, word))
        return Doc((body.fragments, word, *rest), FORM, counts=counts or body.counts, behind=True)

    def before(self, head: Fragments, body: Doc, otherwise: Doc | None = None) -> Doc:
        """Print a form that stands before its body, and reaches to the right; its `otherwise` is said as it is."""
        if otherwise is None:
            body = self.inside(body, False)
            return Doc((*head, body.fragments), FORM, True, body.takes_otherwise, body.counts)
        word = self.word("otherwise")
        body = self.inside(body, body.reaches or body.takes_otherwise or self.reads_on(body, word))
        fragments = (*head, body.fragments, word, otherwise.fragments)
        return Doc(fragments, FORM, True, otherwise.takes_otherwise, body.counts or otherwise.counts)


def _with_flags(node: ast.Ast, said: Doc, parts: list[Doc]) -> Doc:
    """Return the document with the flags of its parts."""
    operator = node.operator if isinstance(node, ast.Chain) else ""
    joins = operator in ("sequence", "parallel") or any(part.joins for part in parts)
    branches = getattr(node, "otherwise", None) is not None
    chooses = operator == "fallback" or branches or any(part.chooses for part in parts)
    can_skip = isinstance(node, ast.If | ast.Name) or any(part.can_skip for part in parts)
    flagged: Doc = said.replace(joins=joins, chooses=chooses, can_skip=can_skip)
    return flagged


def add_brackets(said: Doc) -> Doc:
    """Return the same in brackets."""
    return Doc((mark(OPEN), said.fragments, mark(CLOSE)), WHOLE)
