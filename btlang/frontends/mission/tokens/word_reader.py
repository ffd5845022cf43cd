"""Reads the words of a line: each is a mark, begins a phrase or a name, or is explained.

A step that reads something returns the word at which to go on; the next step is asked where it returns 0.
"""

from __future__ import annotations

from bisect import bisect_right

from btlang.diagnostics.diagnostic import Diagnostic, diagnostic
from btlang.frontends.mission.symbols.includes import ROLE as INCLUDE
from btlang.frontends.mission.symbols.names import Names
from btlang.frontends.mission.symbols.nodes import Unreadable, read_detail, read_form, read_label, read_node, unreadable
from btlang.frontends.mission.symbols.prefixes import SEPARATORS, Prefix, span_of
from btlang.frontends.mission.token import (
    BEFORE_CONDITIONS,
    RULES,
    Called,
    NodeCall,
    Token,
    constraint_of,
    go_on,
    statement_start,
)
from btlang.frontends.mission.tokens.calls import NEGATED, Calls
from btlang.frontends.mission.tokens.condition_words import (
    asked_there,
    check_negation,
    is_so_of_none,
    placed_before,
    with_each_denied,
    with_words_before,
)
from btlang.frontends.mission.tokens.journey_words import COMES
from btlang.frontends.mission.tokens.order_words import BEFORE_ASIDE, OrderWords
from btlang.frontends.mission.tokens.outcomes import Outcomes
from btlang.frontends.mission.tokens.partial_commands import may_be_doing
from btlang.frontends.mission.tokens.partial_conditions import PartialConditions
from btlang.frontends.mission.tokens.places import Places
from btlang.frontends.mission.tokens.remarks import Remarks
from btlang.frontends.mission.tokens.repeated_statements import AGAIN
from btlang.frontends.mission.tokens.requests import Requests
from btlang.frontends.mission.tokens.settling import first_word
from btlang.frontends.mission.tokens.silent_words import (
    MARKS,
    after_politeness,
    begins,
    begins_item,
    begins_question,
    verb_forms,
    without_meaning,
)
from btlang.frontends.mission.tokens.tries import Tries
from btlang.frontends.mission.tokens.unknown_words import UnknownWords
from btlang.frontends.mission.tokens.visitors import Visitors
from btlang.text.words import END_OF_STATEMENT, END_OF_TEXT, Words
from btlang.tree.answers import UNANSWERED
from btlang.vocabulary.entry import Meaning
from btlang.vocabulary.language_tables import CONNECTIVES, NOT_ALONE, ORDER, QUESTIONS
from btlang.vocabulary.lexicon import NODE_ROLES
from btlang.vocabulary.match import Match
from btlang.vocabulary.node_forms import node_details
from btlang.vocabulary.reading_context import ReadingContext
from btlang.vocabulary.trie import longest
from btlang.vocabulary.value_type import TEXT
from btlang.vocabulary.word_tree import SLOTS

_ROLES = {
    "if_it_works": ("if_possible", "if_works"),
    "in_parallel": ("in_parallel", "meanwhile"),
    "stop_that": ("stop_when", "stop_when"),
}
"""What a word is inside a statement, and where it goes on with the one before."""
_NOT_READ = frozenset((*SEPARATORS, INCLUDE, *NOT_ALONE))
_CONDITIONS = frozenset(("condition", *NEGATED))
_JOINING = ("and", "or")
_END_OTHERWISE = (";", ")")
_ASKING = BEFORE_CONDITIONS | {"wait_until", "wait_for", "wait_up_to", "check"}

TYPE_CHECKING = False
if TYPE_CHECKING:
    from btlang.frontends.mission.tokens.condition_words import Origin
_ARRIVAL = {"at": "by_time", "delay": "within"}
"""What the words for a start mean for an arrival: `be back at the dock in 10 minutes`."""


class WordReader:
    """Reads the words of one text into `tokens`; what is wrong with them becomes `problems`."""

    def __init__(
        self,
        text: Words,
        names: Names,
        context: ReadingContext,
        tokens: list[Token],
        problems: list[Diagnostic],
        explain: bool,
    ) -> None:
        self._text, self._names, self._context, self._tokens, self._problems = text, names, context, tokens, problems
        self._explain, self._vocabulary = explain, names.vocabulary
        vocabulary, self._named = self._vocabulary, names.definitions.trie
        self._bounds = [*names.bounds, len(text.words)]
        has_values = names.known or names.bounds  # a name in it may be longer than a phrase
        self._meanings_of = CONNECTIVES.keys() if names.meanings else ()
        self._found = {} if has_values else names.phrases.fixed
        self._calls = Calls(text, vocabulary, context, problems)
        self._partial = PartialConditions(text, vocabulary, self._named, context, self._calls, tokens)
        shared = text, vocabulary, context, self._calls, self._partial, tokens
        self._order, self._places, self._tries = OrderWords(*shared), Places(*shared), Tries(*shared)
        self._requests, self._outcomes, self._visitors = Requests(*shared), Outcomes(*shared), Visitors(*shared)
        self._partial.with_text = self._requests.value_in
        self._remarks = Remarks(text, vocabulary, context)
        self._verb_forms = verb_forms(text, vocabulary)
        self._unknown = UnknownWords(
            text, vocabulary, context, names.definitions, self._partial, tokens, problems, self._verb_forms
        )
        self._details = {*vocabulary.firsts["called"], *vocabulary.firsts["with"], *vocabulary.firsts["giving"]}
        self._details |= node_details(vocabulary).keys()
        self._asking = {*vocabulary.asking["asking_be"], *vocabulary.asking["asking_do"]}
        self._joint = vocabulary.word("and")
        self._is_apart = False  # the statement that is read runs at another time than the next one
        self._origin: Origin | None = None  # the latest condition of the line that was read as a whole
        self._shares = False  # the match at hand has the words of that condition in front
        self._root = vocabulary.trie  # where the match at hand was found

    def read_line(self, first: int, last: int, is_statement: bool, is_followed: bool = True) -> None:
        """Read the words of a line from one to another (exclusive), with which a statement may begin."""
        if is_statement:
            self.end_statement()
        self._read(first, last)

    def pass_bounds(self, at: int) -> None:
        """Know the values that are known at a word."""
        self._bounds = self._bounds[bisect_right(self._bounds, at) :]
        self._context.set_known(self._names.known_at(at))

    def _read(self, at: int, last: int) -> None:
        words, others, tokens = self._text.words, self._names.others, self._tokens
        self._origin = None
        while at < last:
            if at >= self._bounds[0]:
                self.pass_bounds(at)
            if at in others:
                at = self._no_command(at)
            elif tokens and tokens[-1].kind in BEFORE_ASIDE and (end := self._order.aside(at)):
                self._is_apart = tokens[statement_start(tokens, len(tokens))].kind in RULES
                at = end
            elif words[at] in MARKS:
                tokens.append(Token(MARKS[words[at]], self._text.starts[at], self._text.ends[at]))
                if words[at] == END_OF_STATEMENT and at + 1 < last and at + 1 not in self._text.going_on:
                    self.end_statement()
                elif words[at] in _END_OTHERWISE:
                    self._calls.end_otherwise()
                at += 1
            else:
                at = self._phrase(at, last)

    def finish(self) -> None:
        """Say what is left to say at the end of a text."""
        self._unknown.finish()

    def end_statement(self) -> None:
        """Pronouns reach back to earlier statements, but not out of a definition or a standing rule."""
        self._calls.end_statement()
        if self._is_apart:
            self._context.forget()
            self._is_apart = False

    def _no_command(self, at: int) -> int:
        """A statement about a value of the mission, a fact, or the head of a definition."""
        if at in self._names.prefixes:
            return self._statement(self._names.prefixes[at], at)
        if at in self._names.ends:
            return self._names.ends[at]
        header = self._names.definitions.headers[at]
        self._context.forget()
        self._is_apart = True
        self._tokens.append(Token("define", self._text.starts[at], self._text.ends[header.body - 1], header))
        return header.body

    def _phrase(self, at: int, last: int) -> int:
        """What begins at a word, known or unknown."""
        if form := self._form(at) or (self._label(at) if self._text.words[at][0] == '"' else 0):
            return form
        if end := self._detail_before(at):
            return end
        match = self._requests.with_time(self._requests.with_name(self._match(at), at), at)
        match = self._visitors.with_event(match, at)
        match = self._without_measure(match, at)
        if match is not None and match.meaning.role in NODE_ROLES:
            if end := self._node(match, at):
                return end
            match = None
        match = self._with_names(match, at)
        said = self._vocabulary.values.role_words
        if (
            match is not None
            and match.meaning.role == "then"
            and said.introduces(self._text.words, at) > match.last - at
        ):
            match = None  # `next to the table`
        role = match.meaning.role if match is not None else ""
        if match is not None and role == "then" and self._is_end_condition(match, at):
            match, role = Match(Meaning("if"), at + 1), "if"
        if match is not None and role == "if_works" and self._outcomes.asks_anew(match, at):
            role = "and" if self._text.words[at] in self._vocabulary.roles["and"] else "if"
            match = Match(Meaning(role), at + 1)
            self._text.going_on.discard(at)
        if match is not None and role in _ARRIVAL and self._is_to_be_there():
            role = _ARRIVAL[role]
            match = match.replace(meaning=Meaning(role))
        if match is not None and role in ("politeness", "never") and self._unknown.is_doubtful(match, role, at):
            match, role = None, ""
        end = self._sentence(match, role, at)
        if not end and (role in NOT_ALONE or self._text.words[at] in self._verb_forms):
            end = self._in_its_place(match, role, at)
        if not end and role == "but":
            end = self._order.left_out(at)  # `go to every room, but not the kitchen`
        if not end and self._shares and match is not None and self._depends_behind(match.last):
            end = self._partial.add_left_out(at)  # `bring her the cup if she says cup, and the book if she says book`
        if not end and (match is None or match.meaning.entry is not None):
            end = self._left_out(match, role, at)
        if not end and match is not None and role not in _NOT_READ:
            return self._known(match, at)
        return end or self._other(match, role, at, last)

    def _depends_behind(self, at: int) -> bool:
        """Whether what something depends on begins at a word: `if C`."""
        behind = longest(self._vocabulary.trie, self._text, at, self._context)
        return behind is not None and behind.meaning.role in ("if", "unless")

    def _is_to_be_there(self) -> bool:
        """Whether the command before says where the robot is to be, `be back at the dock`, and not that it sets out."""
        before = self._tokens[-1:]
        is_command = before != [] and before[0].kind == "command"
        return is_command and first_word(before[0], self._text.source) in self._vocabulary.asking["being"]

    def _without_measure(self, match: Match | None, at: int) -> Match | None:
        """The same without a text that begins how long it may take: `welcome Bob with a limit of 5 s`."""
        if match is None or not match.values or match.values[-1].type != TEXT:
            return match  # as nearly always
        text = match.values[-1]
        if not match.last == text.last == text.first + 1:
            return match
        other = longest(self._vocabulary.trie, self._text, text.first - 1, self._context)
        if other is None or other.meaning.entry is not None or other.last <= match.last:
            return match
        return self._partial.in_order(range(at, text.first - 1)) or match

    def _is_end_condition(self, match: Match, at: int) -> bool:
        """Whether words that go on with what was done stand at the end: `say hi to Bob when you see him`."""
        text = self._text
        if text.words[at] not in self._vocabulary.asked_once or text.words[match.last] not in (
            END_OF_STATEMENT,
            END_OF_TEXT,
        ):
            return False
        asked = longest(self._vocabulary.trie, text, at + 1, self._context)
        return asked is not None and asked.meaning.role in _CONDITIONS

    def _match(self, at: int) -> Match | None:
        """The phrase at a word, which was looked for before unless values or commands that share a thing may end it."""
        trie, names = self._vocabulary.trie, self._named
        if at not in self._found or at in self._partial.sharing:
            return longest(trie, self._text, at, self._context, names)
        match = self._found[at]
        if names and match is not None and any(value.more for value in match.values):
            match = longest(trie, self._text, at, self._context, names)  # a name may end the list
        return match

    def _with_names(self, match: Match | None, at: int) -> Match | None:
        """The same, a name that is longer, or the rest of a condition with the words of the one before it in front."""
        names, tokens = self._named, self._tokens
        self._root, self._shares = self._vocabulary.trie, False
        if names and (self._text.words[at] in names or SLOTS in names):
            named = longest(names, self._text, at, self._context, self._root)
            if named is not None and (match is None or named.last >= match.last):
                match, self._root = named, names
        if self._origin is not None and tokens[-1].kind in _JOINING:
            if match is None or match.meaning.role in ("not", "never", "condition"):  # `or don't answer`, `or near`
                shared, problem = with_words_before(
                    self._origin, tokens, self._text, match, at, self._vocabulary, names, self._context
                )
                self._problems += [problem] if problem is not None else []
                self._shares = shared is not None
                match = shared or match
        return match

    def _sentence(self, match: Match | None, role: str, at: int) -> int:
        """Replies, prohibitions, questions, wishes and remarks."""
        tokens, text = self._tokens, self._text
        if end := self._outcomes.read(at) or self._order.hours(at) or self._order.until_none(at):
            return end
        is_first = begins(tokens)
        if end := self._requests.reply(at, role):
            return end
        if match is not None and role == "if_unanswered" and (end := self._requests.silence(match, at)):
            return self._outcomes.unanswered(end)
        if match is not None and role == "never" and (end := self._partial.add_forbidden(at, match.last)):
            return end
        if role != "command":
            is_question = role in QUESTIONS
            if (is_question or text.words[at] in self._asking) and begins_question(tokens, is_question):
                if end := self._requests.question(match, role, at):
                    return end
            if is_first and (end := self._requests.begged(at)):
                return end
        tells = is_first and self._remarks.is_possible and not (tokens and tokens[-1].kind == "define")
        if tells and (match is None or role in ("condition", "there_are")):
            if end := self._remarks.end(at):
                self._problems.append(diagnostic("BT158", (span := text.span(at, end)), words=span.text))
                return end + (text.words[end] == ",")
        return 0

    def _in_its_place(self, match: Match | None, role: str, at: int) -> int:
        """Words that say something in one place only, and forms of verbs. Returns where to go on, 0 for any other."""
        text, tokens = self._text, self._tokens
        if match is not None and role in ORDER:
            self._is_apart |= role == "any_time"
            if role in ("tries", "at_most", "up_to_times"):
                return self._tries.number(match, at)
            if role == "stop_after":
                return self._order.stop_after(match, at)
            return self._tries.again(match, at) if role == "try_again" else self._order.read(match, at)
        if role == "ordinal" and match is not None and at not in text.articles and begins_item(tokens):
            last = match.last + (text.words[match.last] == ",")
            self._order.note_late(at, last)
            return last
        if match is not None and role == "mind":
            return self._partial.add(match.last)
        if match is not None and role == "keep" and self._order.is_doing(match.last):
            tokens.append(Token("repeat", text.starts[at], text.ends[match.last - 1], role="doing"))
            return match.last
        end = self._partial.add_doing(at, match) if at and may_be_doing(tokens) else 0
        return end or self._partial.add_third(at, match) or self._partial.add_pause(at)

    def _left_out(self, match: Match | None, role: str, at: int) -> int:
        """Where a command is done, and commands that share their thing."""
        tokens = self._tokens
        if (match is None or role == "condition") and tokens and tokens[-1].kind in ("command", "wait"):
            if end := self._places.at_goal(at) or self._places.behind(at) or self._visitors.read(at):
                self._is_apart |= tokens[statement_start(tokens, len(tokens))].kind in RULES
                return end
        if (match is None or role == "condition") and tokens and tokens[-1].kind in AGAIN:
            if end := self._places.again_at(at):
                return end
        if match is None and begins(tokens) and (end := self._places.before(at)):
            return end
        is_choice = role == "condition" and [token.kind for token in tokens[-2:]] == ["command", "or"]
        if is_choice and (end := self._partial.add_left_out(at)):
            return end  # `look for Bob in the hall or in the lab`
        if match is None or (role == "command" and not match.values and self._text.words[match.last] == self._joint):
            return self._partial.add_sharing(at, match)
        return 0

    def _other(self, match: Match | None, role: str, at: int, last: int) -> int:
        """Words that are no phrase, or one that doesn't stand alone: they say something here, or are unknown."""
        tokens, text = self._tokens, self._text
        asks = tokens[-1:] != [] and tokens[-1].kind in _ASKING
        end = (
            (self._partial.add_condition(at) or self._requests.answered(at) if asks else self._requests.replied(at))
            or without_meaning(tokens, text, match, role, at, self._vocabulary, self._context)
            or self._order.no_phrase(at)
            or self._partial.performed(at)
            or self._partial.add_left_out(at)
            or self._partial.add_without_theme(at)
            or self._requests.tell(at)
            or self._order.left_out(at)
            or self._requests.benefit(at)
        )
        if end:
            return end
        told = self._unknown.told(at, last)
        if told is not None:
            end = told[0]
            self._problems += [told[1]] if self._explain or not told[1].is_error else []
            if not told[1].is_error:
                del tokens[len(tokens) - (tokens[-1:] != [] and tokens[-1].kind == "comma") :]
                return end + (text.words[end] == ",")
        else:
            end = self._unknown.end(at, last)
            end += role == INCLUDE and text.words[end][0] == '"'
            if self._explain:
                self._unknown.report(at, end, match)
        tokens.append(Token("unknown", text.starts[at], text.ends[end - 1]))
        return end

    def _known(self, match: Match, at: int) -> int:
        """A phrase, a connective or a name."""
        tokens, role = self._tokens, match.meaning.role
        if role in ("then", "otherwise") and begins(tokens):
            if role == "otherwise" or not self._outcomes.goes_on_endlessly():
                self._outcomes.doubt_rule(role, at, match.last)
        if role == "politeness" and self._text.words[at] in self._vocabulary.asking["lasting"]:
            self._order.lasts(at)
        if role == "meanwhile" and (end := self._order.during(match)):
            return end
        if role == "politeness" or (role in ("following", "then", "whenever") and self._order.says_nothing(match, at)):
            return after_politeness(tokens, self._text.words, match)
        if at in self._text.going_on:
            go_on(tokens)
            role = self._outcomes.going_on(role, self._text.span(at, match.last))
        if end := self._read_otherwise(match, role, at):
            return end
        match = self._order.for_anybody(self._places.looking_there(match)) if match.values else match
        if role in _CONDITIONS:
            self._places.ask_in_each(match)
            match = asked_there(match, tokens, self._text, self._context, self._vocabulary)
            if (end := self._condition(match, at)) > match.last:
                return end
        elif end := self._operand(match, role, at):
            self._calls.note(match)
            return end
        if self._text.words[match.last] in self._details and match.meaning.entry is not None:
            end = self._calls.with_details(tokens[-1], match.last, self._named)
            self._calls.note(match)
            return end
        end = self._connect(match, role, at) if match.meaning.entry is None else match.last
        if self._calls.says_who(match):
            self._calls.note(match, tokens[-2].kind if len(tokens) > 1 else "")
        return end

    def _read_otherwise(self, match: Match, role: str, at: int) -> int:
        """Phrases that are a part of a command where they stand."""
        if role == "condition":
            return self._places.in_place_of_command(match, at)
        if role in ("at", "every_day"):
            return self._order.times(match, at)
        if role in ("wait_time", "until_time"):
            return self._order.until_both(match, at)
        if role == "count":
            return self._order.rounds(match, at)
        if role == "retry":
            return self._tries.retry(match, at)
        if role == "check":
            return self._order.inspection(at, match.last)
        is_wait = match.meaning.entry is not None and match.meaning.entry.id == COMES
        if (is_wait or role in ("wait_for", "wait_up_to")) and (end := self._order.wait_for_event(match, at)):
            return end
        if role == "command" and at in self._text.articles:  # `then the dock`: with an article it is a name
            return self._partial.add_left_out(at, match.last)
        return 0

    def _condition(self, match: Match, at: int) -> int:
        """The tokens of a condition, and what it says of the command before it. Returns where to go on."""
        tokens, start = self._tokens, self._text.starts[at]
        if match.meaning.role != "condition":
            tokens.append(Token("not", start, start))
            if not self._shares:
                self._problems += check_negation(self._text, match, at, self._vocabulary, tokens)
            match = with_each_denied(self._text, match, at, self._vocabulary)
        token = self._calls.token(match, at)
        if is_so_of_none(token.value, self._text, match, at, self._vocabulary):
            token.value = token.value.replace(joiner="or")
        placed_before(token, self._tokens, self._vocabulary, self._text.source)
        self._requests.said(token, at)
        last = self._requests.whole_answer(token, match)
        tokens.append(token)
        if match.meaning.role != "negated_twice":
            shared = self._origin if self._shares else None
            self._origin = (token, *shared[1:]) if shared is not None else (token, at, match, self._root)
        if isinstance(token.value, Called) and token.value.entry.id == UNANSWERED:
            return self._outcomes.unanswered(match.last)
        return self._outcomes.settle(last) if len(tokens) > 2 else last

    def _is_said_twice(self, said: Token) -> bool:
        """Whether a command is that before `and` in other words: `take it to the lab and leave it there`."""
        if len(self._tokens) < 2 or self._tokens[-1].kind != "and" or not isinstance(said.value, Called):
            return False
        if len(self._tokens) > 2 and self._tokens[-3].kind == "both":
            return False  # `both call staff and ask for help` says two
        before, source = self._tokens[-2], self._text.source.text
        is_same = before.kind == "command" and before.value == said.value and not said.value.entry.accompaniment
        return is_same and source[before.start : before.end].lower() != source[said.start : said.end].lower()

    def _operand(self, match: Match, role: str, at: int) -> int:
        """The token of a command or connective; where a value in it is asked for, the commands that say it."""
        tokens, word = self._tokens, self._text.words[at]
        said = self._calls.token(match, at)
        if tokens and tokens[-1].kind == "not" and role == "command":
            self._requests.otherwise()
        end = self._requests.value_in(match, at, said) if match.values and match.meaning.entry else 0
        if end:
            return self._visitors.read_met(end) or end
        if (word in self._unknown.before_doing or word in self._verb_forms) and constraint_of(said) is not None:
            said.role = "fronted"
        if self._is_said_twice(said):
            tokens.pop()
            tokens[-1].end = said.end
            return match.last
        tokens.append(said)
        if end := self._visitors.read_met(match.last):
            return end
        self._requests.note_question(said)
        self._requests.note_other(match)
        self._outcomes.give_up(match.last)
        self._places.search_there(match)
        self._visitors.in_each()
        if len(tokens) > 1 and tokens[-2].kind == "while" and constraint_of(said) is not None:
            tokens[-2].kind = "while_doing"  # `while avoiding the kitchen`
        return 0

    def _connect(self, match: Match, role: str, at: int) -> int:
        """What the token of a connective is where it stands. Returns where to go on."""
        tokens = self._tokens
        if role in self._meanings_of:
            words = " ".join(self._text.words[at : match.last])
            tokens[-1].role = self._names.meanings.get(words, tokens[-1].role)
        if role in RULES:
            self._is_apart = True
        if role in ("if", "unless"):
            self._requests.finding_out(match.last)
            self._order.rule_of(tokens[-1])
        if role == "otherwise":
            self._requests.note_answerer()
        self._order.connect(role)
        if role == "apart" and len(tokens) > 1:
            self._tries.paused()
        if role in _ROLES:
            tokens[-1].kind = _ROLES[role][len(tokens) > 1 and tokens[-2].kind == "stop"]
        return self._outcomes.connect(match, role, at)

    def _statement(self, prefix: Prefix, at: int) -> int:
        """A statement about a value of the mission. Returns where to go on."""
        from btlang.frontends.mission.tokens.assignments import read_statement  # most missions have none

        read = read_statement(prefix, self._text, at, self._vocabulary, self._context, self._calls)
        if read is None:
            span = span_of(self._text, at)
            if self._explain and (
                prefix.role in ("each", "remember") or prefix.key in self._names.known
            ):  # else it has been reported
                self._problems.append(self._unknown.why(at, at, Match(Meaning(prefix.role), at)))
            self._tokens.append(Token("unknown", span.start, span.end))
            return bisect_right(self._text.starts, span.end - 1)
        self._tokens.append(read[0])
        return read[1]

    def _form(self, at: int) -> int:
        """A node that is said with the children below it, at the start of a statement. Returns where to go on, or 0."""
        tokens, text = self._tokens, self._text
        if not begins(tokens):
            return 0
        read = read_form(text, at, self._vocabulary, self._names.definitions.trie)
        if read is None:
            return 0
        tokens.append(Token("node", text.starts[at], text.ends[read[1] - 1], read[0]))
        return read[1]

    def _label(self, at: int) -> int:
        """The name of a node before it, at the start of a statement. Returns where to go on, or 0."""
        label = read_label(self._text, at, self._vocabulary) if begins(self._tokens) else None
        if label is None:
            return 0
        name, end = label
        self._tokens.append(Token("label", self._text.starts[at], self._text.ends[end - 1], name))
        return end

    def _detail_before(self, at: int) -> int:
        """A condition before its node, which is all of a statement: `while "x < 3", do push cart`. Returns where to go
        on, or 0.
        """
        tokens, text = self._tokens, self._text
        if text.words[at] not in self._details:
            return 0  # as nearly always
        is_first = begins(tokens) or tokens[-1].kind == "label"
        found = read_detail(text, at, self._vocabulary) if is_first else None
        head = self._match(found[2] + 1) if found is not None and text.words[found[2]] == "," else None
        if found is None or head is None or head.meaning.role != "do":
            return 0
        count, end = len(tokens), self._node(head, found[2] + 1)
        call = tokens[-1].value if len(tokens) > count else None
        is_whole = text.words[end] in (END_OF_STATEMENT, END_OF_TEXT, ":")  # else it may be for what follows, too
        if not isinstance(call, NodeCall) or found[0] in dict(call.ports) or not is_whole:
            del tokens[count:]
            return 0
        tokens[-1].value, tokens[-1].start = call.replace(ports=(*call.ports, found[:2])), text.starts[at]
        return end

    def _node(self, head: Match, at: int) -> int:
        """A node that is said by its id. Returns where to go on, 0 where the words are no such node."""
        text, names = self._text, self._named
        named = longest(names, text, at, self._context) if names else None
        is_described = head.last in text.articles and not self._names.definitions.subtrees
        if is_described and not (names and longest(names, text, head.last, self._context)):
            return 0  # `do the round`
        if named is not None and named.last > head.last and text.words[head.last][0] != '"':
            return 0  # `do twist is turn right`
        try:
            definitions = self._names.definitions
            read = read_node(text, head.last, head.meaning, self._vocabulary, definitions.subtrees, definitions.trie)
        except Unreadable as problem:
            self._problems.append(unreadable(text, at, problem))
            end = self._unknown.end(at, bisect_right(text.starts, span_of(text, at).end - 1))
            self._tokens.append(Token("unknown", text.starts[at], text.ends[end - 1]))
            return end
        if read is None:
            return 0
        call, end = read
        said = next((at for at in range(head.last, end) if text.words[at] in self._details), end)
        if text.words[head.last][0] != '"' and any(at in text.articles for at in range(head.last + 1, said)):
            return 0  # `do frobnicate the gizmo` is no id
        named = longest(names, text, head.last, self._context) if names and head.meaning.role == "do" else None
        if named is not None and named.last >= end and not head.meaning.node:
            return head.last  # `do patrol`
        kind = "condition" if head.meaning.role == "test" else "node" if text.words[end] == ":" else "command"
        self._tokens.append(Token(kind, text.starts[at], text.ends[end - 1], call))
        return end
