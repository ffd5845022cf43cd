"""Words to raw tokens: phrases, connectives, names, brackets, lines and blocks. Collects what is unknown."""

from __future__ import annotations

from bisect import bisect_right
from collections.abc import Callable, Iterator, Mapping

from btlang.diagnostics.diagnostic import Diagnostic, diagnostic
from btlang.frontends.definitions import Definitions, find_definitions
from btlang.frontends.facts import find_facts
from btlang.frontends.heads import JOINTS, Head, find_heads, span_of
from btlang.frontends.includes import ROLE as INCLUDE
from btlang.frontends.includes import Included, find_includes, misplaced
from btlang.frontends.token import Listed, Token
from btlang.text.source import Source, Span
from btlang.text.words import END_OF_STATEMENT, END_OF_TEXT, Words, split
from btlang.tree.ast import Include, all_definitions, all_facts
from btlang.vocabulary.entry import Entry, Meaning
from btlang.vocabulary.references import keys_in, renamed
from btlang.vocabulary.trie import SLOTS, Match, SlotValue, longest
from btlang.vocabulary.values import Known, key_of
from btlang.vocabulary.vocabulary import Vocabulary

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import TypeAlias

    Load: TypeAlias = Callable[[str, Span], Included | None]
else:
    Load = None

_MARKS = {",": "comma", ";": "semi", ":": "colon", "(": "open", ")": "close"}


class Lexer:
    """Reads one source. `tokens` are raw tokens, `problems` what was unknown; both are complete after construction.

    With `explain` False nothing is said about unknown words, which takes time. `load` reads the missions that this one
    includes; without it their names are unknown. `known` are values that it may use though it does not set them.
    """

    def __init__(
        self,
        source: Source,
        vocabulary: Vocabulary,
        explain: bool = True,
        load: Load | None = None,
        known: Mapping[str, Known] | None = None,
    ) -> None:
        self._explain, self._given, self._named = explain, vocabulary, known
        self.text: Words = split(source, vocabulary.articles)
        self.vocabulary = vocabulary
        self.problems: list[Diagnostic] = [
            diagnostic("BT004", span, fix=(Span(source, span.end, span.end), '"')) for span in self.text.open_quotes
        ]
        self.problems += [diagnostic("BT003", span, characters=span.text[:20]) for span in self.text.unreadable]
        includes = find_includes(self.text, vocabulary)
        loaded = [(path, span, load(path, span)) for path, span in includes.found] if load is not None else []
        self.includes = [Include(path, part.mission, span) for path, span, part in loaded if part is not None]
        self.is_including = bool(includes.found)
        self._parts = {path: part for path, _, part in loaded if part is not None}
        parts = list(self._parts.values())
        facts = find_facts(self.text, vocabulary)
        self.problems += facts.problems
        self.facts = facts.found
        self._ends = includes.ends | facts.ends
        places = [*(fact for part in parts for fact in all_facts(part.mission)), *self.facts]
        if places:
            self.vocabulary = vocabulary.with_places(tuple(dict.fromkeys(fact.name for fact in places)))
        shared = [definition for part in parts for definition in all_definitions(part.mission)]
        self._heads = find_heads(self.text, self.vocabulary)
        named = {head.words for head in self._heads.values()}
        self.definitions: Definitions = find_definitions(self.text, self.vocabulary, self._ends, named, shared)
        self._bounds = [len(self.text.words)]
        self.known = {key: value for named in (known or {}, *(p.known for p in parts)) for key, value in named.items()}
        """The values that hold in the whole mission, by key."""
        if self.known or self._heads or any(header.parameters for header in self.definitions.headers.values()):
            self._name_values()
        self.problems += self.definitions.problems
        self._others = {*self._heads, *self._ends, *self.definitions.headers}
        """The words at which something stands that is no phrase."""
        self.values = self.vocabulary.values.for_reading()
        self.tokens: list[Token] = []
        self._lines()
        self.conditions: set[str] = self._condition_names({name for part in parts for name in part.conditions})
        """The defined names that stand for conditions."""
        for token in self.tokens:
            if token.kind == "name":
                token.kind = "condition" if called(token).id in self.conditions else "command"

    def again(self, source: Source) -> Lexer:
        """Another text in the place of this one; it may include what this one does, and nothing is said about it."""
        return Lexer(source, self._given, explain=False, load=lambda path, _: self._parts.get(path), known=self._named)

    def _name_values(self) -> None:
        from btlang.frontends.variables import Variables  # most missions have none

        self._variables = Variables(self.text, self.vocabulary, self._heads, self.definitions, self.known)
        self.known = self._variables.everywhere
        self._bounds = [*self._variables.bounds, *self._bounds]
        self.problems += self._variables.problems

    def _lines(self) -> None:
        """Line ends, indents and dedents around the tokens of each line, as in Python."""
        lines = self.text.lines
        indents = [lines[0].indent] if lines else [0]
        opens_block = False
        for number, line in enumerate(lines):
            if line.indent > indents[-1]:
                if opens_block:
                    indents.append(line.indent)
                    self._mark("indent", line.first)
                else:
                    self.problems.append(diagnostic("BT006", self.text.span(line.first, line.first)))
            else:
                if opens_block:
                    self.problems.append(diagnostic("BT027", self._last_span()))
                while line.indent < indents[-1] and len(indents) > 1:
                    indents.pop()
                    self._mark("dedent", line.first)
                if line.indent != indents[-1]:
                    self.problems.append(diagnostic("BT007", self.text.span(line.first, line.first)))
            if number and not opens_block:
                self._mark("newline", line.first)
            if line.indent <= indents[0]:
                self.values.latest.clear()  # pronouns do not reach beyond a statement
            self._line(line.first, line.last)
            opens_block = bool(self.tokens) and self.tokens[-1].kind == "colon"  # politeness may stand behind it
        if opens_block:
            self.problems.append(diagnostic("BT027", self._last_span()))
        for _ in indents[1:]:
            self._mark("dedent", len(self.text.words) - 1)

    def _line(self, at: int, last: int) -> None:
        text, names, trie, values = self.text, self.definitions.trie, self.vocabulary.trie, self.values
        words, starts, ends, tokens = text.words, text.starts, text.ends, self.tokens
        headers, heads, others = self.definitions.headers, self._heads, self._others
        while at < last:
            word = words[at]
            if at >= self._bounds[0]:
                self._bounds = self._bounds[bisect_right(self._bounds, at) :]
                values.set_known(self._variables.at(at))
            if at in others:
                if at in heads:
                    at = self._statement(heads[at], at)
                elif at in self._ends:
                    at = self._ends[at]
                else:
                    header = headers[at]
                    tokens.append(Token("define", header, starts[at], ends[header.body - 1]))
                    at = header.body
                continue
            if word in _MARKS:
                tokens.append(Token(_MARKS[word], None, starts[at], ends[at]))
                if word == END_OF_STATEMENT:
                    values.latest.clear()
                at += 1
                continue
            match = longest(trie, text, at, values, names)
            if names and (word in names or SLOTS in names):
                named = longest(names, text, at, values, trie)
                if named is not None and (match is None or named.last >= match.last):
                    match = named
            role = match.meaning.role if match is not None else ""
            if match is None or role in JOINTS or role == INCLUDE:
                end = self._unknown_end(at, last)
                if role == INCLUDE:
                    end += words[end][0] == '"'
                if self._explain:
                    self.problems.append(self._why(at, end, match))
                tokens.append(Token("unknown", None, starts[at], ends[end - 1]))
                at = end
            else:
                if role == "politeness":
                    at = self._politeness(match, at)
                    continue
                if role == "negated":
                    tokens.append(Token("not", None, starts[at], starts[at]))
                tokens.append(self._phrase(match, at))
                for value in match.values:
                    values.latest[value.type] = value.text if not value.more else value.more[-1]
                at = match.last

    def _why(self, at: int, end: int, match: Match | None) -> Diagnostic:
        """What is wrong with words that are no phrase, or one that stands where it cannot."""
        from btlang.frontends import unknown  # most missions have nothing to explain

        if match is None:
            return unknown.explain_unknown(
                self.text, at, end, self.vocabulary, self.values, self.definitions, self.tokens
            )
        if match.meaning.role == INCLUDE:
            return misplaced(self.text.span(at, end), self.vocabulary)
        return unknown.misread_head(self.text, at, match.meaning.role, self.vocabulary)

    def _politeness(self, match: Match, at: int) -> int:
        """Politeness is left out with the comma beside it: `Robot, go home, please`. Returns where to go on."""
        words, tokens = self.text.words, self.tokens
        if tokens and tokens[-1].kind == "comma" and words[match.last] in (",", ";", ")", END_OF_TEXT):
            tokens.pop()
        elif words[match.last] == "," and (not tokens or tokens[-1].kind not in ("command", "name", "condition")):
            return match.last + 1
        return match.last

    def _phrase(self, match: Match, at: int) -> Token:
        text, meaning = self.text, match.meaning
        values = match.values
        start, end = text.starts[at], text.ends[match.last - 1]
        if values and values[-1].first == match.last:  # the article was the value: `print a`
            end = text.articles[match.last][1]
        if meaning.entry is not None:
            kind = "condition" if meaning.role == "negated" else meaning.role
            return Token(kind, self._called(meaning.entry, match, at), start, end)
        if values:
            return Token(meaning.role, values[0].text, start, end)
        value = str(meaning.value) if meaning.role == "count" else meaning.between or None
        return Token(meaning.role, value, start, end)

    def _called(self, entry: Entry, match: Match, at: int) -> tuple[Entry, tuple[tuple[str, str], ...]] | Listed:
        """The entry with its arguments, or with several of them where one slot holds a list."""
        if entry.sort == "value" and not (self.values.known and entry.id in self.values.known):
            self._unknown_value(self.text.span(at, match.last), entry.id)
        if not match.values:
            return entry, ()
        arguments = tuple([(value.name, self._port_text(value)) for value in match.values])
        lists = [place for place, value in enumerate(match.values) if value.more]
        if not lists:
            return entry, arguments
        if len(lists) > 1:
            self.problems.append(
                diagnostic("BT034", self.text.span(at, match.last), words=self.text.span(at, match.last).text)
            )
        place = lists[0]
        value = match.values[place]
        texts = (value.text, *value.more)
        every = tuple((*arguments[:place], (value.name, text), *arguments[place + 1 :]) for text in texts)
        return Listed(entry, every, value.joiner)

    def _port_text(self, value: SlotValue) -> str:
        """The text of a value; the names in braces in it become keys (BT043 where nothing has such a name)."""
        text = value.text
        if "{" not in text or self.values.types[value.type].kind != "text":
            return text
        text = renamed(text, lambda name: key_of(w for w in name.lower().split() if w not in self.vocabulary.articles))
        known = self.values.known or {}
        for key in keys_in(text):
            if key not in known:
                self._unknown_value(self.text.span(value.first, value.last), key)
        return text

    def _unknown_value(self, span: Span, key: str) -> None:
        from btlang.frontends.unknown import unknown_value

        self.problems.append(unknown_value(span, key, self.values.known or ()))

    def _statement(self, head: Head, at: int) -> int:
        """A statement about a value of the mission. Returns where to go on."""
        from btlang.frontends.remembering import read_statement  # most missions have none

        read = read_statement(head, self.text, at, self.vocabulary, self.values, self._port_text)
        if read is None:
            span = span_of(self.text, at)
            if self._explain and (
                head.role in ("each", "remember") or head.key in self.known
            ):  # else that has been told
                self.problems.append(self._why(at, at, Match(Meaning(head.role), at)))
            self.tokens.append(Token("unknown", None, span.start, span.end))
            return bisect_right(self.text.starts, span.end - 1)
        self.tokens.append(read[0])
        return read[1]

    def _unknown_end(self, at: int, last: int) -> int:
        """Unknown words reach to the next mark or connective, or to a phrase that is more than one word."""
        text = self.text
        while True:
            at += 1
            if at >= last or text.words[at] in _MARKS:
                return at
            match = longest(self.vocabulary.trie, text, at, self.vocabulary.values)
            if match is not None and (match.meaning.entry is None or match.last > at + 1):
                return at

    def _mark(self, kind: str, at: int) -> None:
        start = self.text.starts[at] if at < len(self.text.starts) else len(self.text.source.text)
        self.tokens.append(Token(kind, None, start, start))

    def _last_span(self) -> Span:
        last = self.tokens[-1]
        return Span(self.text.source, last.start, last.end)

    def _condition_names(self, included: set[str]) -> set[str]:
        """A name is a condition where its body holds only conditions, `not`, `and`, `or` and condition names."""
        needs = {name: _names_in_condition(body) for name, body in _bodies(self.tokens)}
        needs |= {name: set() for name in included if name not in needs}
        users: dict[str, list[str]] = {}
        for name, needed in needs.items():
            for other in needed or ():
                users.setdefault(other, []).append(name)
        conditions: set[str] = set()
        ready = [name for name, needed in needs.items() if needed is not None and not needed]
        while ready:
            name = ready.pop()
            conditions.add(name)
            for user in users.get(name, ()):
                waiting = needs[user]
                if waiting is not None:
                    waiting.discard(name)
                    if not waiting:
                        ready.append(user)
        return conditions


def called(token: Token) -> Entry:
    """The entry of a token that is a phrase or a name."""
    entry: Entry = token.value.entry if type(token.value) is Listed else token.value[0]
    return entry


def _bodies(tokens: list[Token]) -> Iterator[tuple[str, list[Token]]]:
    """Each definition's name and the tokens of its body, as far as the line or block goes."""
    for at, token in enumerate(tokens):
        if token.kind != "define":
            continue
        depth, body = 0, []
        for i in range(at + 1, len(tokens)):
            inner = tokens[i]
            depth += (inner.kind == "indent") - (inner.kind == "dedent")
            if depth < 0 or (depth == 0 and inner.kind in ("newline", "semi", "define")):
                break
            body.append(inner)
        yield token.value.name, body


_IN_CONDITIONS = frozenset(("condition", "not", "and", "or", "comma", "open", "close"))


def _names_in_condition(body: list[Token]) -> set[str] | None:
    """The names that a body needs to be conditions in order to be one itself; None where it cannot be one."""
    if not body or not all(token.kind in _IN_CONDITIONS or token.kind == "name" for token in body):
        return None
    return {called(token).id for token in body if token.kind == "name"}
