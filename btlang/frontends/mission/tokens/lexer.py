"""Words to raw tokens: phrases, connectives, names, brackets, lines and blocks. Collects what is unknown."""

from __future__ import annotations

from bisect import bisect_right
from collections.abc import Mapping
from functools import partial

from btlang.diagnostics.diagnostic import Diagnostic, diagnostic
from btlang.frontends.mission.symbols.includes import ROLE as INCLUDE
from btlang.frontends.mission.symbols.names import Load, Names
from btlang.frontends.mission.symbols.nodes import Unreadable, read_node, unreadable
from btlang.frontends.mission.symbols.prefixes import SEPARATORS, Prefix, span_of
from btlang.frontends.mission.token import RULES, Token, constraint_of, go_on
from btlang.frontends.mission.tokens.calls import NEGATED, Calls
from btlang.frontends.mission.tokens.condition_names import condition_names, settle
from btlang.frontends.mission.tokens.condition_words import check_negation, with_words_before
from btlang.frontends.mission.tokens.ended_rules import with_ends
from btlang.frontends.mission.tokens.order_words import OrderWords
from btlang.frontends.mission.tokens.partial_commands import PartialCommands, may_be_doing
from btlang.frontends.mission.tokens.remarks import Remarks
from btlang.frontends.mission.tokens.requests import Requests
from btlang.frontends.mission.tokens.silent_words import (
    MARKS,
    after_politeness,
    begins,
    begins_item,
    begins_question,
    verb_forms,
    without_meaning,
)
from btlang.frontends.mission.tokens.unknown_words import UnknownWords
from btlang.text.source import Source, Span
from btlang.text.words import END_OF_STATEMENT, Words, split
from btlang.vocabulary.entry import Meaning
from btlang.vocabulary.language_tables import CONNECTIVES, NOT_ALONE, ORDER, QUESTIONS
from btlang.vocabulary.lexicon import NODE_ROLES, Lexicon
from btlang.vocabulary.match import Match
from btlang.vocabulary.reading_context import Known, ReadingContext
from btlang.vocabulary.trie import longest
from btlang.vocabulary.word_tree import SLOTS

_ROLES = {"if_it_works": ("if_possible", "if_works"), "in_parallel": ("in_parallel", "meanwhile")}
"""What a word is inside a statement, and where it goes on with the one before."""
_NOT_READ = frozenset((*SEPARATORS, INCLUDE, *NOT_ALONE))
_CONDITIONS = frozenset(("condition", *NEGATED))
_JOINING = ("and", "or")
_REPLIES = ("if_works", "otherwise")
_JOINTS = ("comma", "and", "then")
_BEFORE_CONDITIONS = frozenset(("if", "unless", "while", "until", "whenever", "first_time", "as_soon_as", "not"))
"""Behind these a polite word could be a misspelt one: `wave if now bumped`."""


TYPE_CHECKING = False
if TYPE_CHECKING:
    from btlang.frontends.mission.tokens.condition_words import Origin


class Lexer:
    """Reads one source. `tokens` are raw tokens, `problems` what was unknown; both are complete after construction.

    With `explain` False nothing is said about unknown words, which takes time. `load` reads the missions that this one
    includes; without it their names are unknown. `known` are values that it may use though it does not set them.
    """

    def __init__(
        self,
        source: Source,
        vocabulary: Lexicon,
        explain: bool = True,
        load: Load | None = None,
        known: Mapping[str, Known] | None = None,
    ) -> None:
        self._explain, self._given, self._shared = explain, vocabulary, known
        self.text: Words = split(source, vocabulary.orthography)
        self.problems: list[Diagnostic] = [
            diagnostic("BT004", span, fix=(Span(source, span.end, span.end), '"')) for span in self.text.open_quotes
        ]
        self.problems += [diagnostic("BT003", span, characters=span.text[:20]) for span in self.text.unreadable]
        self.names = Names(self.text, vocabulary, load, known)
        self.problems += self.names.problems
        self.vocabulary = self.names.vocabulary
        self._bounds = [*self.names.bounds, len(self.text.words)]
        self.context = ReadingContext(self.vocabulary.values)
        self.context.keys = self.names.chosen
        has_values = self.names.known or self.names.bounds  # a name in it may be longer than a phrase
        self._meanings_of = CONNECTIVES.keys() if self.names.meanings else ()
        self._found = {} if has_values else self.names.phrases.fixed
        self.tokens: list[Token] = []
        self._calls = Calls(self.text, self.vocabulary, self.context, self.problems)
        self._partial = PartialCommands(
            self.text, self.vocabulary, self.names.definitions.trie, self.context, self._calls, self.tokens
        )
        self._order = OrderWords(self.text, self.vocabulary, self.context, self._calls, self._partial, self.tokens)
        self._requests = Requests(self.text, self.vocabulary, self.context, self._calls, self._partial, self.tokens)
        self._remarks = Remarks(self.text, self.vocabulary, self.context)
        behind = ("called", "with", "giving")
        self._details = {phrase.split()[0] for role in behind for phrase in self.vocabulary.roles[role]}
        self._verb_forms = verb_forms(self.text, self.vocabulary)
        self._before_doing = {phrase.split()[0] for phrase in self.vocabulary.roles["without_entering"]}
        self._asking = {*self.vocabulary.asking["asking_be"], *self.vocabulary.asking["asking_do"]}
        self._joint = self.vocabulary.word("and")
        self._is_apart = False  # the statement that is read runs at another time than the next one
        self._unknown = UnknownWords(
            self.text, self.vocabulary, self.context, self.names.definitions, self._partial, self.tokens, self.problems,
            self._verb_forms,
        )  # fmt: skip
        self._lines()
        self.problems += with_ends(self.tokens, self.vocabulary, partial(Span, source))
        self.conditions = condition_names(self.tokens, self.names.included_conditions())
        """The defined names that stand for conditions."""
        settle(self.tokens, self.conditions)

    def again(self, source: Source) -> Lexer:
        """Another text in the place of this one; it may include what this one does, and nothing is said about it."""
        included = self.names.included
        return Lexer(source, self._given, explain=False, load=lambda path, _: included.get(path), known=self._shared)

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
            if line.indent <= indents[0] and line.first not in self.text.going_on:
                self._end_statement()
            self._line(line.first, line.last)
            opens_block = bool(self.tokens) and self.tokens[-1].kind == "colon"  # politeness may stand behind it
        if opens_block:
            self.problems.append(diagnostic("BT027", self._last_span()))
        for _ in indents[1:]:
            self._mark("dedent", len(self.text.words) - 1)

    def _line(self, at: int, last: int) -> None:
        text, names, trie, context = self.text, self.names.definitions.trie, self.vocabulary.trie, self.context
        words, starts, ends, tokens = text.words, text.starts, text.ends, self.tokens
        found, verb_forms, calls = self._found, self._verb_forms, self._calls
        headers, prefixes, others = self.names.definitions.headers, self.names.prefixes, self.names.others
        going_on, articles, meanings_of = text.going_on, text.articles, self._meanings_of
        remarks = self._remarks if self._remarks.is_possible else None
        asking = self._asking
        sharing, joint = self._partial.sharing, self._joint
        origin: Origin | None = None
        while at < last:
            word = words[at]
            if at >= self._bounds[0]:
                self._bounds = self._bounds[bisect_right(self._bounds, at) :]
                context.set_known(self.names.known_at(at))
            if at in others:
                if at in prefixes:
                    at = self._statement(prefixes[at], at)
                elif at in self.names.ends:
                    at = self.names.ends[at]
                else:
                    header = headers[at]
                    context.latest.clear()
                    context.listed.clear()
                    self._is_apart = True
                    tokens.append(Token("define", starts[at], ends[header.body - 1], header))
                    at = header.body
                continue
            if self._is_apart and tokens and tokens[-1].kind in _JOINTS and (end := self._order.aside(at)):
                at = end
                continue
            if word in MARKS:
                tokens.append(Token(MARKS[word], starts[at], ends[at]))
                if word == END_OF_STATEMENT and at + 1 < last and at + 1 not in going_on:
                    self._end_statement()
                at += 1
                continue
            if at in found and at not in sharing:
                match = found[at]
                if names and match is not None and any(value.more for value in match.values):
                    match = longest(trie, text, at, context, names)  # a name may end the list
            else:
                match = longest(trie, text, at, context, names)
            if match is not None and match.meaning.role in NODE_ROLES:
                end = self._node(match, at)
                if end:
                    at = end
                    continue
                match = None
            root = trie
            if names and (word in names or SLOTS in names):
                named = longest(names, text, at, context, trie)
                if named is not None and (match is None or named.last >= match.last):
                    match, root = named, names
            shared = None
            if origin is not None and tokens[-1].kind in _JOINING and (match is None or match.meaning.role == "not"):
                shared, problem = with_words_before(origin, tokens, text, match, at, self.vocabulary, names, context)
                self.problems += [problem] if problem is not None else []
                match = shared or match
            role = match.meaning.role if match is not None else ""
            if role == "politeness" and tokens and tokens[-1].kind in _BEFORE_CONDITIONS:
                match, role = None, ""
            if match is not None and role == "never" and word in self._before_doing:
                if self._unknown.lack_name(at, match.last):
                    match, role = None, ""
            end = self._partial.add_forbidden(at, match.last) if match is not None and role == "never" else 0
            if role != "command" and not end:
                if (role in QUESTIONS or word in asking) and begins_question(tokens, role in QUESTIONS):
                    end = self._requests.question(match, role, at)
                end = end or (self._requests.begged(at) if begins(tokens) else 0)
            if end:
                at = end
                continue
            if remarks is not None and begins(tokens) and (match is None or role in ("condition", "there_are")):
                end = remarks.end(at)
                if end:
                    span = text.span(at, end)
                    self.problems.append(diagnostic("BT158", span, words=span.text))
                    at = end + (words[end] == ",")
                    continue
            if role in NOT_ALONE or word in verb_forms:
                end = self._in_its_place(match, role, at)
                if end:
                    at = end
                    continue
            if (match is None or role == "condition") and tokens and tokens[-1].kind == "command":
                end = self._order.at_goal(at)
                if end:
                    at = end
                    continue
            if match is None or (role == "command" and not match.values and words[match.last] == joint):
                end = self._partial.add_sharing(at, match)
                if end:
                    at = end
                    continue
            if match is None or role in _NOT_READ:
                end = (
                    without_meaning(tokens, text, match, role, at, self.vocabulary, self.context)
                    or self._order.start_of_leg(at)
                    or self._order.journey_of_constraint(at)
                    or self._order.wait_for(at)
                    or self._partial.add_left_out(at)
                    or self._partial.add_without_theme(at)
                    or self._requests.tell(at)
                    or (self._partial.add_contracted(at) if tokens and tokens[-1].kind in _BEFORE_CONDITIONS else 0)
                )
                if end:
                    at = end
                    continue
                end = self._unknown.end(at, last)
                if role == INCLUDE:
                    end += words[end][0] == '"'
                if self._explain and not self._unknown.is_reported(starts[at], ends[end - 1]):
                    self.problems.append(self._unknown.why(at, end, match))
                tokens.append(Token("unknown", starts[at], ends[end - 1]))
                at = end
            else:
                if role == "politeness" or (role in ("following", "then") and self._order.says_nothing(match, at)):
                    at = after_politeness(tokens, words, match)
                    continue
                if at in going_on:
                    end = self._requests.reply(at) if role in _REPLIES else 0
                    if end:
                        at = end
                        continue
                    go_on(tokens)
                if role == "condition" and len(tokens) > 1 and tokens[-2].kind == "command":
                    end = self._partial.add_left_out(at, match.last)  # `go to the kitchen and then in the lab`
                    if end:
                        at = end
                        continue
                end = self._order.inspection(at, match.last) if role == "check" else 0
                if role == "command" and at in articles:
                    end = self._partial.add_left_out(at, match.last)  # `then the dock`: with an article it is a name
                if role == "condition" and begins(tokens):
                    end = self._partial.add_third(at + 1, None)
                if end:
                    at = end
                    continue
                if role in _CONDITIONS:
                    if role != "condition":
                        tokens.append(Token("not", starts[at], starts[at]))
                        if not shared:
                            self.problems += check_negation(text, match, at, self.vocabulary, tokens)
                    token = calls.token(match, at)
                    tokens.append(token)
                    if role != "negated_twice":
                        origin = (token, *origin[1:]) if shared and origin else (token, at, match, root)
                else:
                    said = calls.token(match, at)
                    if tokens and tokens[-1].kind == "not" and role == "command":
                        self._requests.otherwise()
                    end = self._requests.value_in(match, at, said) if match.values and match.meaning.entry else 0
                    if end:
                        at = end
                        continue
                    if (word in self._before_doing or word in verb_forms) and constraint_of(said) is not None:
                        said.role = "fronted"
                    tokens.append(said)
                    if len(tokens) > 1 and tokens[-2].kind == "while" and constraint_of(tokens[-1]) is not None:
                        tokens[-2].kind = "while_doing"  # `while avoiding the kitchen`
                if words[match.last] in self._details and match.meaning.entry is not None:
                    at = calls.with_details(tokens[-1], match.last, self.names.definitions.trie)
                    calls.note(match)
                    continue
                if role in meanings_of:
                    tokens[-1].role = self.names.meanings.get(" ".join(words[at : match.last]), tokens[-1].role)
                if role in RULES:
                    self._is_apart = True
                if role in ("if", "unless"):
                    self._requests.finding_out(match.last)
                if role == "if_fails":
                    tokens[-1].kind, tokens[-1].value = "or", role
                if role in _ROLES:
                    tokens[-1].kind = _ROLES[role][len(tokens) > 1 and tokens[-2].kind == "stop"]
                if match.values or calls.speaks_of_people:
                    calls.note(match, len(tokens) > 1 and tokens[-2].kind in ("or", "otherwise"))
                at = match.last

    def _end_statement(self) -> None:
        """Pronouns reach back to earlier statements, but not out of a definition or a standing rule."""
        self._calls.end_statement()
        if self._is_apart:
            self.context.latest.clear()
            self.context.listed.clear()
            self._is_apart = False

    def _in_its_place(self, match: Match | None, role: str, at: int) -> int:
        """Words that say something in one place only, and forms of verbs. Returns where to go on, 0 for any other."""
        text, tokens = self.text, self.tokens
        if match is not None and role in ORDER:
            self._is_apart |= role == "any_time"
            return self._order.read(match, at)
        if role == "ordinal" and match is not None and at not in text.articles and begins_item(tokens):
            return match.last + (text.words[match.last] == ",")
        if match is not None and role == "mind":
            return self._partial.add(match.last)
        if match is not None and role == "keep" and self._order.is_doing(match.last):
            tokens.append(Token("repeat", text.starts[at], text.ends[match.last - 1], role="doing"))
            return match.last
        end = self._partial.add_doing(at, match) if at and may_be_doing(tokens) else 0
        return end or self._partial.add_third(at, match)

    def _statement(self, prefix: Prefix, at: int) -> int:
        """A statement about a value of the mission. Returns where to go on."""
        from btlang.frontends.mission.tokens.assignments import read_statement  # most missions have none

        read = read_statement(prefix, self.text, at, self.vocabulary, self.context, self._calls)
        if read is None:
            span = span_of(self.text, at)
            if self._explain and (
                prefix.role in ("each", "remember") or prefix.key in self.names.known
            ):  # else it has been reported
                self.problems.append(self._unknown.why(at, at, Match(Meaning(prefix.role), at)))
            self.tokens.append(Token("unknown", span.start, span.end))
            return bisect_right(self.text.starts, span.end - 1)
        self.tokens.append(read[0])
        return read[1]

    def _node(self, head: Match, at: int) -> int:
        """A node that is said by its id. Returns where to go on, 0 where the words are no such node."""
        text, names = self.text, self.names.definitions.trie
        named = longest(names, text, at, self.context) if names else None
        if named is not None and named.last > head.last and text.words[head.last][0] != '"':
            return 0  # `do twist is turn right`
        try:
            definitions = self.names.definitions
            read = read_node(text, head.last, head.meaning, self.vocabulary, definitions.subtrees, definitions.trie)
        except Unreadable as problem:
            self.problems.append(unreadable(text, at, problem))
            end = self._unknown.end(at, bisect_right(text.starts, span_of(text, at).end - 1))
            self.tokens.append(Token("unknown", text.starts[at], text.ends[end - 1]))
            return end
        if read is None:
            return 0
        call, end = read
        named = longest(names, text, head.last, self.context) if names and head.meaning.role == "do" else None
        if named is not None and named.last >= end and not head.meaning.node:
            return head.last  # `do patrol`
        kind = "condition" if head.meaning.role == "test" else "node" if text.words[end] == ":" else "command"
        self.tokens.append(Token(kind, text.starts[at], text.ends[end - 1], call))
        return end

    def _mark(self, kind: str, at: int) -> None:
        start = self.text.starts[at] if at < len(self.text.starts) else len(self.text.source.text)
        self.tokens.append(Token(kind, start, start))

    def _last_span(self) -> Span:
        last = self.tokens[-1]
        return Span(self.text.source, last.start, last.end)
