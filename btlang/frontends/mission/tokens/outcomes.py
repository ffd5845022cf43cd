"""Conditions that the command before them has settled: `look for the cup. If it isn't there, A`, `wait for Bob. When
he comes, A`, `get the cup. If you can't reach it, A`.

The command fails where the condition doesn't hold. So its denial means that the command failed, and `when` means then.
"""

from __future__ import annotations

from btlang.diagnostics.diagnostic import diagnostic
from btlang.frontends.mission.token import (
    FORMS,
    JOINTS,
    LINES,
    RULES,
    STATEMENT_ENDS,
    Called,
    Listed,
    Token,
    go_on,
    run_start,
    statement_start,
    texts_of,
)
from btlang.frontends.mission.tokens.sentence_reader import SentenceReader
from btlang.text.source import Span
from btlang.vocabulary.capabilities import MOVES
from btlang.vocabulary.match import Match
from btlang.vocabulary.references import choice_of
from btlang.vocabulary.trie import longest
from btlang.vocabulary.value_type import PLACE
from btlang.vocabulary.word_tree import find

_HEARS = "ears"
_JOINTS = JOINTS | STATEMENT_ENDS
_FAILS, _WORKS, _UNANSWERED = "if_fails", "if_works", "if_unanswered"
_MEASURES = frozenset(("for", "up_to", "within", "count"))
_ASKING = frozenset(("if", "as_soon_as", "once"))
_FORMS = FORMS | {"every_day"}


class Outcomes(SentenceReader):
    """Those of one text, behind the tokens that it has so far."""

    _looked: tuple[int, Token | None, int, frozenset[str]] = 0, None, 0, frozenset()
    """How many tokens have been looked at, the last of them, where its statement begins, and the kinds in that."""

    def settle(self, end: int) -> None:
        """What the condition asks that ends at a word is left out where the command before it has settled it."""
        tokens, roles = self._tokens, self._vocabulary.roles
        if self._text.words[end] in (*roles["or"], *roles["and"]):
            return  # `go to Bob. If he isn't there or bumped, A` asks more
        denied = tokens[-2].kind == "not"
        form = len(tokens) - (3 if denied else 2)
        if form < 1 or tokens[form].kind not in _ASKING:
            return
        command = self._before(form)
        if command is None:
            if denied and tokens[form].kind == "if":
                self._join_otherwise(form)
            return
        first = self._statement(command)[0] if denied else command
        if any(_achieves(tokens[at], tokens[-1]) for at in range(command, first - 1, -1)):
            self._join(command, form, tokens[-1].end, denied)

    def unable(self, at: int) -> int:
        """`if you can't grab it`, behind a command about it: if that fails."""
        front, form = find(self._vocabulary.unable, self._text.words, at), len(self._tokens) - 1
        command = self._before(form) if front is not None and form > 0 else None
        if front is None or command is None:
            return 0
        match = longest(self._vocabulary.trie, self._text, front[1], self._context)
        if match is None or match.meaning.entry is None or match.meaning.entry.sort != "action":
            return 0
        if match.meaning.entry.first:
            form += self._reach_search(form, self._text.span(at, match.last))
            command = self._before(form)
            if command is None:
                return 0
        asked = {name for value in match.values for name in _names(value.text)}
        for token in self._tokens[self._statement(command)[0] : command + 1]:
            value = token.value
            if isinstance(value, Called | Listed) and (asked or value.entry.id == match.meaning.entry.id):
                if asked <= _named(value):
                    self._join(command, form, self._text.ends[match.last - 1], True)
                    return match.last
        return 0

    def if_works(self, end: int) -> None:
        """`look for the key, and bring it to me if you find it`: words that end there go before their command."""
        tokens = self._tokens
        command = len(tokens) - 2
        first = run_start(tokens, command, JOINTS)
        found = tokens[first - 1].value if 0 < first < command else None
        if not self._is_end(end) or tokens[command].kind != "command" or not isinstance(found, Called | Listed):
            return
        if found.entry.achieves:
            start = tokens[command].start
            tokens[first:] = [Token("stop", start, start), Token(_WORKS, start, start), tokens[command]]

    def found(self, match: Match, at: int) -> None:
        """`look for the key. When you find it, A, if not B`: with the `if not` it is `if that works`."""
        tokens, words = self._tokens, self._text.words
        as_soon_as = (phrase.split()[0] for phrase in self._vocabulary.roles["as_soon_as"])
        once = {*self._vocabulary.asked_once, *self._vocabulary.roles["once"], *as_soon_as}
        if words[at] not in once and words[at + 1] not in once:
            return
        end = self._end_of_statement(at)
        commas = (i + 1 for i in range(match.last + 1, end) if words[i] == ",")
        replies = (find(self._vocabulary.replies, words, i) for i in commas)
        if any(reply is not None and not reply[0] for reply in replies):
            form = tokens.pop()
            while tokens and tokens[-1].kind in ("comma", "stop"):
                tokens.pop()
            tokens += [Token("stop", form.start, form.start), Token(_WORKS, form.start, form.end)]

    def _statement(self, end: int) -> tuple[int, frozenset[str]]:
        """Where the statement begins in which the tokens before one stand, and their kinds.

        A statement that goes on and on is looked at from where it was looked at last.
        """
        tokens, (done, latest, start, kinds) = self._tokens, self._looked
        is_known = 0 < done <= end and tokens[done - 1] is latest
        at, found = end, set[str]()
        while at > (done if is_known else 0) and tokens[at - 1].kind not in LINES:
            at -= 1
            found.add(_FAILS if tokens[at].value == _FAILS else tokens[at].kind)
        if is_known and at == done:
            at, found = start, found | kinds
        self._looked = end, tokens[end - 1] if end else None, at, frozenset(found)
        return at, self._looked[3]

    def _before(self, form: int) -> int | None:
        """The command right before a form, with measures of it between them; None where it may not have run."""
        tokens, command = self._tokens, form - 1
        while command >= 0 and tokens[command].kind in _JOINTS:
            command -= 1
        is_new = any(token.kind in STATEMENT_ENDS for token in tokens[command + 1 : form])
        while command > 0 and tokens[command].kind in _MEASURES:
            command -= 1
        if command < 0 or tokens[command].kind != "command":
            return None
        if is_new and not _FORMS.isdisjoint(self._statement(command)[1]):
            return None  # `If bumped, look for the cup. If it isn't there, A`
        return command

    def _join(self, command: int, form: int, end: int, denied: bool) -> None:
        """Makes a form that ends at a character the word between the command and what comes behind."""
        tokens, behind = self._tokens, command + 1
        while tokens[behind].kind in _MEASURES:
            behind += 1
        is_new = any(token.kind in STATEMENT_ENDS for token in tokens[behind:form])
        meaning = self._meaning(tokens[form], denied, is_new)
        if meaning is None:
            return
        meaning.end = end
        del tokens[form:]
        if is_new:
            go_on(tokens)
            role = meaning.kind if meaning.value is None else str(meaning.value)
            if role != (role := self.going_on(role, Span(self._text.source, meaning.start, end))):
                meaning = Token(role, meaning.start, end)
        else:
            del tokens[behind:]
        tokens.append(meaning)

    def _join_otherwise(self, form: int) -> None:
        """`look for the cup. If it is there, A. If it isn't there, B`: the second is `otherwise`."""
        tokens = self._tokens
        before = run_start(tokens, form, STATEMENT_ENDS)
        start, end = tokens[form].start, tokens[-1].end
        if before < form and _WORKS in self._statement(before)[1]:
            if self._denies_what_worked(Span(self._text.source, start, end)):
                del tokens[form:]
                go_on(tokens)
                tokens.append(Token("otherwise", start, end))

    def _meaning(self, form: Token, denied: bool, is_new: bool) -> Token | None:
        """What a form says that asks what the command has settled: that it failed, or worked, or `then`."""
        word, at = self._text.source.text[form.start : form.end].lower(), form.start
        if denied:
            return Token("or", at, at, _FAILS) if form.kind == "if" else None
        if form.kind != "if" or word in self._vocabulary.asked_once:
            return Token("then", at, at)
        return Token(_WORKS, at, at) if is_new else None

    def going_on(self, role: str, words: Span) -> str:
        """The role of words that go on with the statement before: `if you don't find it` denies `if you find it`.

        BT168 for what goes on with a failure where something stands between: `A. If that fails, B. Otherwise C`.
        BT145 for silence behind what is no question: `ask "Tea?". If she says no, A. If she says nothing, B`.
        """
        word = self._vocabulary.word
        if role == _UNANSWERED and not self._asks():
            example = f'ask "Tea?". {word(_WORKS).capitalize()}, wave. {word("otherwise").capitalize()} nod'
            self._calls.problems.append(diagnostic("BT145", words, words=words.text.rstrip(","), example=example))
        if role not in ("otherwise", _FAILS, _WORKS):
            return role
        if role == _FAILS and not set(self._vocabulary.asking["search"]).isdisjoint(_words(words.text)):
            self._reach_search(len(self._tokens), words)
        kinds = self._statement(len(self._tokens))[1]
        if role == _FAILS and _WORKS in kinds and self._denies_what_worked(words):
            return "otherwise"
        if _WORKS in kinds if role == _FAILS else _FAILS in kinds and _WORKS not in kinds:
            self._unclear(words)
        return role

    def _unclear(self, words: Span) -> None:
        """BT168: about which command the words are."""
        word = self._vocabulary.word
        example = f"dock. {word(_WORKS)}, wave. {word('otherwise')} nod"
        self._calls.problems.append(diagnostic("BT168", words, words=words.text, example=example))

    def _reach_search(self, end: int, words: Span) -> int:
        """`Look for the key. Pick it up. If you can't find it, A`: the statements up to the search become one.

        `end` is behind the last of them. Returns by how many tokens there are more or fewer. BT168 where forms stand
        between.
        """
        tokens, count, joints = self._tokens, len(self._tokens), list[tuple[int, int]]()
        end = run_start(tokens, end, STATEMENT_ENDS)
        first = statement_start(tokens, end)
        while not any(map(_searches, tokens[first:end])):
            behind, first = first, run_start(tokens, first, STATEMENT_ENDS)
            if first == behind or not first or not _FORMS.isdisjoint(token.kind for token in tokens[behind:end]):
                if any(map(_searches, tokens[:behind])):
                    self._unclear(words)
                return 0
            joints.append((first, behind))
            first, end = statement_start(tokens, first), first
        if _FORMS.isdisjoint(token.kind for token in tokens[first:end]):
            for before, behind in joints:
                at = tokens[before].start
                tokens[before:behind] = [] if tokens[behind].kind == "then" else [Token("then", at, at)]
            self._looked = 0, None, 0, frozenset()
        elif joints:
            self._unclear(words)
        return len(tokens) - count

    def _denies_what_worked(self, words: Span) -> bool:
        """Whether the words deny the latest ones by which the statement asked whether its command worked."""
        at = next(at for at in reversed(range(len(self._tokens))) if self._tokens[at].kind == _WORKS)
        worked, pronouns = self._tokens[at], self._vocabulary.values.pronouns
        asked, said = _words(self._text.source.text[worked.start : worked.end]), _words(words.text)
        if any(PLACE in pronouns.get(word, ()) for word in said) and any(map(_moves, self._tokens[at:])):
            return False  # `if he is there, go to the lab. If he isn't there, A`: it may be about the lab
        denied = (
            [*asked[:at], *way.split(), *asked[at + 1 :]]
            for at, verb in enumerate(asked)
            for way in self._vocabulary.negations.get(verb, ())
        )
        return any(said[-len(each) :] == each for each in denied)

    def _asks(self) -> bool:
        """Whether the latest command waits for what somebody says."""
        said = next((token.value for token in reversed(self._tokens) if token.kind == "command"), None)
        return isinstance(said, Called | Listed) and _HEARS in said.entry.needs

    def doubt_rule(self, role: str, at: int, last: int) -> None:
        """BT151 for what may be a part of the rule before it: `whenever bumped, wave. Then dock`."""
        end = run_start(self._tokens, len(self._tokens), STATEMENT_ENDS)
        words, text = self._text.span(at, last), self._text
        if not end or "\n" in text.source.text[self._tokens[end - 1].end : words.start]:
            return
        kinds = self._statement(end)[1]
        if kinds.isdisjoint(RULES) or (role == "otherwise" and "if" in kinds):
            return
        last += text.words[last] == ","
        rest = self._end_of_statement(last)
        said = text.span(last, rest).text if rest > last else "..."
        word = self._vocabulary.word(_FAILS if role == "otherwise" else role)
        one = f"... {word} {said}" if role == "then" else f"{word}, {said}"
        self._calls.problems.append(diagnostic("BT151", words, words=words.text, one=one, other=said))


def _words(text: str) -> list[str]:
    return text.lower().rstrip(",").split()


def _searches(token: Token) -> bool:
    return isinstance(token.value, Called | Listed) and token.value.entry.first


def _moves(token: Token) -> bool:
    return isinstance(token.value, Called | Listed) and MOVES in token.value.entry.resources


def _achieves(command: Token, asked: Token) -> bool:
    """Whether a condition holds once a command has succeeded: it is about the same things."""
    value, condition = command.value, asked.value
    if not isinstance(value, Called | Listed) or not isinstance(condition, Called):
        return False
    return condition.entry.id in value.entry.achieves and {text for _, text in condition.arguments} <= _named(value)


def _named(value: Called | Listed) -> set[str]:
    """What refers to the values of a command."""
    return {name for text in texts_of(value) for name in _names(text)}


def _names(text: str) -> set[str]:
    """What refers to the value of a port: its text, and the key of what is chosen."""
    choice = choice_of(text)
    return {text} if choice is None else {text, f"{{{choice.key}}}"}
