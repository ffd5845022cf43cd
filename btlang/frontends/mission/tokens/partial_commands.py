"""Commands that are not written whole: `then to the office`, and the form of a verb behind `while`, `before`, `keep`.

Both are read as the words that they stand for would be, in a text put together for that.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence

from btlang.frontends.mission.token import (
    LINES,
    Called,
    Listed,
    Token,
    arguments_of,
    constraint_of,
    run_start,
    with_arguments,
)
from btlang.frontends.mission.tokens.calls import Calls
from btlang.frontends.mission.tokens.left_out import complete, keep_theme, left_out
from btlang.frontends.mission.tokens.word_matches import (
    DOING,
    doing,
    match_of,
    relocated,
    rest_of,
    theme_of,
    words_of,
)
from btlang.text.words import Words
from btlang.vocabulary.entry import GOAL, RECIPIENT, THEME
from btlang.vocabulary.lexicon import Lexicon
from btlang.vocabulary.match import Match
from btlang.vocabulary.reading_context import ReadingContext
from btlang.vocabulary.references import ALL, NAMES, Choice, choice_of
from btlang.vocabulary.trie import TrieNode, longest
from btlang.vocabulary.value_type import OBJECT, PERSON

BEFORE_DOING = frozenset(("before", "after", "while", "until", "never", "followed_by", "meanwhile"))
"""The kinds of tokens behind which a command may have the form of its verb: `after waving`."""
JOINTS = frozenset(("then", "and", "or", "comma", "otherwise", "before", "after"))
"""Behind these a command may leave out words of the one before it."""
_LISTING = frozenset(("and", "comma", "then"))
_COMMANDS = frozenset(("command", "name"))
_EITHER_END = (["for", "or"], ["up_to", "or"])  # `for 10 s or 2 m` says two ends of one command, not two commands
LONGEST_VERB = 4
"""Words from the first one of a command or condition up to its verb."""


class PartialCommands:
    """Those of one text, while its `tokens` are read; the functions return the word at which to go on, 0 for none."""

    def __init__(
        self,
        text: Words,
        vocabulary: Lexicon,
        names: TrieNode,
        context: ReadingContext,
        calls: Calls,
        tokens: list[Token],
    ) -> None:
        self._text, self._vocabulary, self._context, self._calls = text, vocabulary, context, calls
        self._tokens = tokens
        self._tries = vocabulary.trie, names
        self._and = frozenset(vocabulary.roles["and"])
        self.with_text: Callable[[Match, int, Token], int] = lambda _match, _at, _token: 0
        """Reads what a command says or asks where that is no text in quotes, as behind the verb itself."""
        self.sharing: set[int] = set()
        """The words at which commands begin that share their theme with the one before."""
        self._said: dict[int, list[int]] = {}  # the words of commands that leave some out, by where these begin

    def doing(self, at: int) -> Match | None:
        """The command whose verb has the form that stands there: `going to the lab`."""
        return doing(self._text, at, self._vocabulary.doing, self._tries, self._context)

    def with_front(
        self,
        at: int,
        end: int,
        words: Sequence[str],
        trie: TrieNode | None = None,
        left_out: range = range(0),
        is_whole: bool = False,
    ) -> Match | None:
        """The phrase that `words` (`go to`) make of the name behind the words from one on: `on the way to the lab`.

        Some words may be left out of it. `is_whole`: `words` alone are one, too.
        """
        if not words:
            return None
        places = [*[at] * len(words), *(place for place in rest_of(self._text, end) if place not in left_out)]
        tries = self._tries[:1] if trie is None else (trie,)
        match = match_of(self._text, places, dict(enumerate(words)), tries, self._context)
        return relocated(match, places) if match is not None and match.last + is_whole > len(words) else None

    def in_order(self, places: Sequence[int]) -> Match | None:
        """The phrase that words of the text make in another order; `last` is the place behind its latest word."""
        match = match_of(self._text, places, {}, self._tries, self._context)
        return relocated(match, places) if match is not None else None

    def add_doing(self, at: int, other: Match | None) -> int:
        """Such a command, unless another phrase is as long."""
        match, before = self.doing(at), self._tokens[-1]
        if match is None or (other is not None and other.last >= match.last):
            return 0
        end = match.last
        if before.kind == "if" and len(self._tokens) > 1 and constraint_of(self._tokens[-2]) is not None:
            before.kind = "while"  # `avoid the hall when going to the lab`
        if before.kind == "if":
            failing = longest(self._vocabulary.trie, self._text, end, self._context)
            if failing is None or failing.meaning.role != "fails":
                return 0
            end = failing.last
        before.kind = {"if": "if_doing", "while": "while_doing", "followed_by": "then"}.get(before.kind, before.kind)
        token = self._token_of(match, at)
        token.role = "doing"
        placed = self._place(match, at, token)
        return placed if end == match.last else end  # a text may end before its phrase

    def add(self, at: int) -> int:
        """The same where nothing before it is changed: `would you mind waving`."""
        match = self.doing(at)
        return self._place(match, at, self._token_of(match, at)) if match is not None else 0

    def _place(self, match: Match, at: int, token: Token) -> int:
        """Adds a command in a form of its verb, with its text. Returns where to go on."""
        if end := self.with_text(match, at, token):
            return end
        self._tokens.append(token)
        return match.last

    def append(self, match: Match, at: int) -> None:
        """Adds a command that was found so."""
        self._tokens.append(self._token_of(match, at))

    def add_third(self, at: int, other: Match | None) -> int:
        """A command in the third person: `the robot goes to the lab, then waves`."""
        tokens, text = self._tokens, self._text
        if at == 0 or text.words[at - 1] not in self._vocabulary.asking["subject"]:
            before = _command_before(tokens) if tokens and tokens[-1].kind in JOINTS else None
            if before is None or before.role != "third":
                return 0
        match = doing(text, at, self._vocabulary.third_person, self._tries, self._context)
        if match is None or (other is not None and other.last >= match.last):
            return 0
        token = self._token_of(match, at)
        token.role = "third"
        return self._place(match, at, token)

    def add_pause(self, at: int) -> int:
        """`go to the lab and the hall, stopping for a minute in each`: it waits there."""
        tokens = self._tokens
        if len(tokens) < 2 or tokens[-1].kind != "comma" or tokens[-2].kind != "command":
            return 0
        match = doing(self._text, at, self._vocabulary.doing, self._tries, self._context)
        if match is None or match.meaning.role != "wait":
            return 0
        tokens[-1].kind = "and"
        return self._place(match, at, self._token_of(match, at))

    def add_forbidden(self, at: int, end: int) -> int:
        """Such a constraint. Returns where to go on, 0 where there is none."""
        match = self.forbidden(at, end)
        if match is None:
            return 0
        self.append(match, at)
        return match.last

    def forbidden(self, at: int, end: int) -> Match | None:
        """A constraint, by the word for `never` in the place of those at a word: `you must not enter the hall`."""
        match = self.with_front(at, end, (self._vocabulary.word("never"),))
        entry = match.meaning.entry if match is not None else None
        return match if entry is not None and entry.constrains else None

    def add_left_out(self, at: int, least: int = 0) -> int:
        """A command whose first words are those of the one before it, and which ends at a word `least` or behind it."""
        read = self._left_out(at)
        if read is None or read[0].last < least:
            return 0
        people = self._people()
        token, before = self._token_of(read[0], at), said_before(self._tokens)
        if before is not None and self._only_says_goal(read[0], at):
            keep_theme(token, before)
            del self._tokens[-2:]
            if not self._tokens or self._tokens[-1].kind not in JOINTS:
                self._tokens.append(token)
                return read[0].last
            before = said_before(self._tokens)
        complete(token, before)
        if self._tokens[-1].kind in ("and", "then", "comma"):
            self._list_people(people)
        is_further = before is not None and self._calls.search_on(before, read[0])
        if is_further is None:
            return 0
        if before is not None and is_further:
            del self._tokens[run_start(self._tokens, len(self._tokens), JOINTS) :]
            before.end = token.end
            return read[0].last
        self._said[token.start] = read[1]
        self._share_recipient(token)
        enlist(self._tokens, token)
        return read[0].last

    def _only_says_goal(self, match: Match, at: int) -> bool:
        """Whether words behind a comma only say the goal that a command lacks: `bring the cup, to the lab`."""
        before, entry = self._tokens[-2] if len(self._tokens) > 1 else None, match.meaning.entry
        value, speaker = before.value if before is not None else None, self._vocabulary.values.role_words.speaker
        if self._tokens[-1].kind != "comma" or before is None or before.kind != "command" or entry is None:
            return False
        if not isinstance(value, Called | Listed):
            return False
        goals, own = (
            {*entry.slots_of(GOAL), *entry.slots_of(RECIPIENT)},
            {each for row in arguments_of(value) for each, _ in row},
        )
        added = {each.name for each in match.values if each.first >= at}
        is_new = bool(added) and added <= goals - own and own == {*value.entry.slots_of(THEME)}
        return is_new and speaker.isdisjoint(self._words_of(before))

    def _people(self) -> tuple[str, ...]:
        """The names of whom `them` stands for."""
        listed, latest = (choice_of(found.get(PERSON, "")) for found in (self._context.listed, self._context.latest))
        names = dict(listed.parts).get(NAMES, "") if listed is not None else ""
        named = self._context.latest.get(PERSON, "") if latest is None else ""
        return tuple(names.split(";")) if names else (named,) * (named[:1] not in ("", "{"))

    def _list_people(self, before: tuple[str, ...]) -> None:
        """`give the cup to Alice and the book to Bob and tell them "Tea"`: both of them."""
        latest, key = self._people()[-1:], self._context.keys.get(PERSON, PERSON)
        if before and latest and latest[0] not in before:
            group = Choice(ALL, PERSON, key, ((NAMES, ";".join((*before, *latest))),))
            self._context.listed[PERSON] = group.text

    def add_further(self, before: Token, at: int) -> int:
        """The same command as another one, with words of that left out."""
        words = self._said.get(before.start) or words_of(self._text, before)
        read = left_out(self._text, words, at, self._tries, self._context) if words else None
        value = before.value
        if read is None or not isinstance(value, Called | Listed) or read[0].meaning.entry is not value.entry:
            return 0
        token = self._token_of(read[0], at)
        self._said[token.start] = read[1]
        self._tokens.append(token)
        return read[0].last

    def _share_recipient(self, last: Token) -> None:
        """`bring the cup from the kitchen and the book from the lab to Alice`: she gets both."""
        said, speaker = last.value, self._vocabulary.values.role_words.speaker
        if not isinstance(said, Called | Listed) or self._tokens[-1].kind not in _LISTING:
            return
        slots = said.entry.slots_of(RECIPIENT)
        given = tuple((name, value) for name, value in arguments_of(said)[-1] if name in slots)
        for token in reversed(self._tokens):
            value = token.value
            if token.kind == "command" and isinstance(value, Called | Listed) and value.entry is said.entry:
                own = arguments_of(value)
                has_own = any(name in slots for each in own for name, _ in each)
                if has_own or not speaker.isdisjoint(self._words_of(token)):
                    return
                token.value = with_arguments(value, [(*each, *given) for each in own])
            elif token.kind == "command" and speaker.isdisjoint(self._words_of(token)):
                complete(token, last)  # `take the cup and all plates to the lab`
                if token.value is value:
                    return
            elif token.kind not in _LISTING and token.role != "list":
                return

    def _words_of(self, token: Token) -> list[str]:
        return [self._text.words[at] for at in words_of(self._text, token)]

    def named(self, at: int) -> Match | None:
        """The name of a definition at a word."""
        return longest(self._tries[1], self._text, at, self._context) if self._tries[1] else None

    def performed(self, at: int) -> int:
        """`run the tour`: the name of a definition, before which it says nothing. Returns where that begins."""
        if self._text.words[at] not in self._vocabulary.asking["performing"]:
            return 0
        return at + 1 if self.named(at + 1) is not None else 0

    def add_without_theme(self, at: int) -> int:
        """A command about the thing of the one before, which it leaves out: `pick up the cup and put in the box`."""
        before = said_before(self._tokens)
        is_list = before is not None and isinstance(before.value, Listed)
        if before is None or is_list or OBJECT not in self._context.latest:
            return 0  # of a list it would be the last thing alone
        for pronoun, types in self._context.pronouns.items():
            match = self.with_front(at, at + 1, (self._text.words[at], pronoun)) if OBJECT in types else None
            theme = theme_of(match) if match is not None else None
            if match is not None and theme is not None and theme.first == at and theme.type == OBJECT:
                self._tokens.append(self._token_of(match, at))
                return match.last
        return 0

    def add_sharing(self, at: int, match: Match | None) -> int:
        """A command whose theme is said behind the next one, which means the same thing: `find and bring the cup`."""
        text, verbs = self._text, range(at + 1, min(at + LONGEST_VERB, len(self._text.words)))
        if match is not None and (match.meaning.role != "command" or match.values):
            return 0
        last = match.last if match is not None else next((i for i in verbs if text.words[i] in self._and), 0)
        if not last or text.words[last] not in self._and:
            return 0
        other = longest(self._tries[0], text, last + 1, self._context)
        theme = theme_of(other) if other is not None else None
        goes = text.words[at] in self._vocabulary.journey_verbs and last > at + 1
        if theme is None or goes:
            return 0  # `go in and photograph the sink`
        places = [*range(at, last), *range(theme.first, theme.last)]
        found = match_of(text, places, {}, self._tries[:1], self._context)
        if found is None or found.last != len(places) or found.meaning.role != "command":
            return 0
        if [(value.first, value.type) for value in found.values] != [(last - at, theme.type)]:
            return 0
        token = self._token_of(relocated(found, places), at)
        token.end = text.ends[last - 1]
        self._tokens.append(token)
        self._context.same[theme.first] = theme.last
        self.sharing.add(last + 1)
        return last

    def _token_of(self, match: Match, at: int) -> Token:
        token = self._calls.token(match, at)
        self._calls.note(match)
        return token

    def _left_out(self, at: int) -> tuple[Match, list[int]] | None:
        said = said_before(self._tokens)
        if said is None or [token.kind for token in self._tokens[-2:]] in _EITHER_END:
            return None
        if self._vocabulary.values.exception(self._text, at):
            return None  # `take all cups to the lab, except the red one`
        words = self._said.get(said.start) or words_of(self._text, said)
        if not words:
            return None  # an answer
        return left_out(self._text, words, at, self._tries, self._context)


def said_before(tokens: Sequence[Token]) -> Token | None:
    """The command before the joining word at the end, in the same bracket."""
    at = len(tokens) - 1
    if at < 0 or tokens[at].kind not in JOINTS:
        return None
    depth = 0
    while at and depth >= 0:
        at -= 1
        token = tokens[at]
        if token.kind in ("define", "unknown"):
            return None
        if token.role != "list":
            depth += (token.kind in ("close", "dedent")) - (token.kind in ("open", "indent"))
        if not depth and token.kind in _COMMANDS:
            return token
    return None


def may_be_doing(tokens: Sequence[Token]) -> bool:
    """Whether a command that comes may have the form of its verb: behind such a word or another such command."""
    if not tokens or tokens[-1].kind in ("if", "try", *BEFORE_DOING) or tokens[-1].role == "doing":
        return bool(tokens)
    if tokens[-1].kind not in JOINTS:
        return False
    before = _command_before(tokens)
    return before is not None and before.role == "doing"


def _command_before(tokens: Sequence[Token]) -> Token | None:
    """The latest command of the line, or what the line begins with."""
    return next((token for token in reversed(tokens) if token.kind in DOING or token.kind in LINES), None)


def enlist(tokens: list[Token], command: Token) -> None:
    """Adds a command that left words out: behind a comma, `and` or `or` it goes on with the command as a list does."""
    joint = len(tokens) - 1
    first = joint - (tokens[joint - 1].kind == "comma")
    before = tokens[first - 1]
    if tokens[joint].kind not in ("and", "or", "comma") or not (before.kind in _COMMANDS or before.role == "list"):
        tokens.append(command)
        return
    if tokens[joint].kind == "and":
        tokens[joint].role = "then"
    if before.role == "list":
        del tokens[first - 1]
    else:
        tokens.insert(first - 1, Token("open", before.start, before.start, role="list"))
    tokens += (command, Token("close", command.end, command.end, role="list"))
