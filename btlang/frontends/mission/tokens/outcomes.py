"""Conditions that the command before them has settled: `look for the cup. If it isn't there, A`, `wait for Bob. When
he comes, A`, `get the cup. If you can't reach it, A`.

The command fails where the condition doesn't hold. So its denial means that the command failed, and `when` means then.
"""

from __future__ import annotations

from btlang.diagnostics.diagnostic import diagnostic
from btlang.frontends.mission.token import (
    JOINTS,
    STATEMENT_ENDS,
    Called,
    Listed,
    Token,
    go_on,
    run_end,
    run_start,
    statement_start,
)
from btlang.frontends.mission.tokens.going_on import BRANCHES
from btlang.frontends.mission.tokens.limits import Limits
from btlang.frontends.mission.tokens.sentence_reader import may_fail, searches
from btlang.frontends.mission.tokens.settling import (
    FAILS,
    MEASURES,
    WORKS,
    achieves,
    asked_about,
    has_it,
    is_about,
    is_somebody_else,
    names_of,
    settle,
    takes,
)
from btlang.frontends.mission.tokens.silent_words import begins
from btlang.frontends.mission.tokens.tries import LIMIT
from btlang.text.source import Span
from btlang.tree.rounds import ONE_FAILS
from btlang.vocabulary.antecedents import pronouns_for
from btlang.vocabulary.capabilities import TRAVELS
from btlang.vocabulary.match import Match
from btlang.vocabulary.value_type import OBJECT, PERSON, PLACE
from btlang.vocabulary.word_tree import find

_ASKING = frozenset(("if", "as_soon_as", "once"))
_DENIED = (("not", "condition"), ("unless", "condition"))
_WHERE, _DONE = ("PersonIsAt", "ObjectIsAt"), ("command", "name")


class Outcomes(Limits):
    """Those of one text, behind the tokens that it has so far."""

    def connect(self, match: Match, role: str, at: int) -> int:
        """What the token of words about how it went is where it stands. Returns where to go on."""
        tokens, token, said = self._tokens, self._tokens[-1], match.meaning.role
        if role == "then" and len(self._tokens) > 1:
            self.found(match, at)
        if said == "once" and len(self._tokens) > 1:
            if self._text.words[match.last] in (",", *self._vocabulary.roles["and"]):
                done = tokens[-2].value
                if isinstance(done, Called | Listed) and TRAVELS in done.entry.needs:
                    tokens.pop()  # `go to every room once and wave in each one`
                else:
                    token.kind, token.value = "count", "1"
                return match.last
        if role == WORKS and self._text.words[at] in self._vocabulary.joining and tokens[-2:-1] != []:
            if tokens[-2].kind not in (*JOINTS, *STATEMENT_ENDS):
                tokens.insert(-1, Token("comma", token.start, token.start))  # `pick it up and if that works, wave`
        if role == "for" and begins(tokens[-2:-1]) and (behind := self._phrase(match.last)) is not None:
            if behind.meaning.role == "command":  # `for 5 minutes wave`
                tokens.append(Token("comma", token.end, token.end))
                return match.last
        if role in ("for", "up_to"):
            self._limit_wait()
            self._limit_sought(self._is_end(match.last))
        if role == "until" and len(self._tokens) > 1 and self._tokens[-2].role == LIMIT:
            self._doubt_count(self._tokens[-2], match, at)
        if role == ONE_FAILS and not self._in_round():
            words = self._text.span(at, match.last - (self._text.words[match.last - 1] == ","))
            self._calls.problems.append(diagnostic("BT067", words, words=words.text))
        if role in ("delay", "at"):
            self._ask_later()
        if role in (FAILS, WORKS) and len(tokens) > 2:
            last = run_start(tokens, len(tokens) - 1, JOINTS | STATEMENT_ENDS | MEASURES) - 1
            self._make_fail(last)
        if role in (WORKS, "otherwise") and find(self._vocabulary.replies, self._text.words, at) is not None:
            self._ask_alone()
            if role == WORKS:
                self._doubt_so(match.last, at)
        if role == FAILS and not self._searching.isdisjoint(self._text.words[at : match.last]):
            self._ask_after_all()  # `when you have found it, A, and if it's nowhere, B`
        if role == FAILS and self._denies_before(self._text.span(at, match.last), len(tokens) - 1):
            role = "otherwise"  # `if you find it, A, and if you can't find it, B`
        if role in (FAILS, ONE_FAILS, "if_unanswered", "otherwise"):
            token.kind = "or" if role != "otherwise" else role
            token.value = FAILS if said != "otherwise" else None
        if role == said == "otherwise":
            self.turns(token)
        if said == "if_unanswered":
            self._doubt_silence(self._text.span(at, match.last))
        if said == "if_unanswered" and at not in self._text.going_on:
            self.check_asked(match, at)
            self.try_question(len(self._tokens) - 1)
        if role in (WORKS, "if_it_works", FAILS):
            self.trailing(match.last)
        if role == "if_unanswered":
            return self.unanswered(match.last)
        return self._limit_before(match.last, role) if said in (WORKS, FAILS) else match.last

    def _doubt_count(self, count: Token, match: Match, at: int) -> None:
        """BT151 for `turn left up to 8 times until C`: at most so often, or so often again and again."""
        number = self._text.source.text[count.start : count.end]
        span = Span(self._text.source, count.start, self._text.ends[match.last - 1])
        one, other = f"... {number}", f"... {self._text.span(at, match.last).text} ..."
        self._calls.problems.append(diagnostic("BT151", span, words=span.text, one=one, other=other))

    def settle(self, end: int) -> int:
        """Leave out a condition that ends at a word if the command before it has settled it; return where to go on."""
        tokens, roles = self._tokens, self._vocabulary.roles
        if self._is_end(end) or self._text.words[end] in (*roles["or"], *roles["and"]):
            return end  # `go to Bob. If he isn't there or bumped, A` asks more; `say hi to Bob when he comes`
        denied, asked = tokens[-2].kind == "not", tokens[-1]
        form = len(tokens) - (3 if denied else 2)
        if form < 1 or tokens[form].kind not in _ASKING:
            return end
        form -= self._free_wait(form)
        wait = self._waited(form, lambda token: self._is_settled(token, asked))
        if wait is not None and tokens[wait + 1].kind == "until_time":
            self._deny_before(form)
            return end
        if denied and tokens[form].kind == "if" and tokens[form - 1].kind == "comma":
            at = asked_about(tokens, form, lambda token: self._is_settled(token, asked))
            if at is not None and at + 1 < run_start(tokens, form, JOINTS):  # `when you find it, A, if you don't, B`
                tokens[form - 1].kind = "semi"
        if denied and tokens[form].kind == "if" and tokens[form - 1].kind in ("semi", "newline"):
            waited = asked_about(tokens, form, lambda token: token.kind != "command" and self._is_settled(token, asked))
            at = asked_about(tokens, form, lambda token: self._is_settled(token, asked)) if waited is None else waited
            while at is not None and (before := self._settled_before(at, asked)) is not None:
                at = before  # `bring Bob the cup and tell him "Tea!". If he isn't there, A`
            is_free = BRANCHES.isdisjoint(self._statement(form - 1)[1])
            may_ask = at is None or not is_free or self._may_ask_again(at, form, end)
            if waited is not None and not is_free and self._is_event(asked):
                return self._deny_wait(waited, form, end)
            if at is None and is_free and self._is_event(asked):
                at, may_ask = self._wait_before(form, asked, end), False
                form = len(tokens) - 3
            if at is not None and not may_ask and settle(tokens[:form], at):
                self._doubt_place(at, form)
                return self._settle(at, form, asked.end, end)
        command = self._before(form)
        somebody = self._vocabulary.negative_subjects
        if command is not None and not denied and is_somebody_else(tokens[command], asked, somebody):
            return end  # `count the people and tell Bob. If anybody is there, A`
        if command is None:
            if denied and tokens[form].kind == "if":
                self._join_otherwise(form)
            elif not denied and tokens[form].kind == "if":
                return self._go_on_then(form, end)
            return end
        first = self._statement(command)[0] if denied else command
        if denied and wait is not None:
            then = next((at for at in range(wait, form) if tokens[at].kind == "then"), 0)
            if then and tokens[then - 1].kind == "stop":
                return self._turn(wait, then, form, end)
        has_found = not denied and searches(tokens[command]) and has_it(tokens[command], asked)
        if has_found or any(achieves(tokens[at], asked) for at in range(command, first - 1, -1)):
            said = tokens[command]
            self._join(command, form, asked.end, denied)
            return self._limit(said, end) if denied else end
        return end

    def _deny_wait(self, waited: int, form: int, end: int) -> int:
        """`wait up to 5 min until somebody comes. If she says yes, A. If nobody comes, B`: B if the wait fails."""
        tokens, words = self._tokens, Span(self._text.source, self._tokens[form].start, self._tokens[-1].end)
        behind = run_end(tokens, waited + 1, MEASURES | STATEMENT_ENDS)
        is_alone = tokens[waited + 1].kind not in ("and", "or")  # not one of two that are waited for
        if tokens[behind].kind != WORKS and is_alone and settle(tokens[:form], waited, with_branches=True):
            return self._settle(waited, form, words.end, end, with_branches=True)
        if tokens[behind].kind != WORKS:
            self._unclear(words)
            return end
        del tokens[form:]
        go_on(tokens)
        tokens.append(Token("otherwise", words.start, words.end))
        return end

    def _settle(self, at: int, form: int, stop: int, end: int, with_branches: bool = False) -> int:
        """Makes words from a form up to a character, and a word, ask whether the command at a place failed."""
        tokens, start = self._tokens, self._tokens[form].start
        del tokens[form:]
        go_on(tokens)
        command = tokens[at]
        self._make_fail(at)
        role = self._settle_command(at, with_branches)
        tries = self._tries_of(tokens.index(command), end)
        if not role:
            self._unclear(Span(self._text.source, start, stop))
        tokens.append(Token("otherwise" if role == "otherwise" else "or", start, stop, FAILS))
        return tries or self._limit(command, end)

    def read(self, at: int) -> int:
        """Words that go on with what has happened to the command before them. Returns where to go on, 0 for others."""
        if self._tokens and self._tokens[-1].kind == "if":
            return self._unable(at) or self._name_fails(at) or self._is_so(at)
        word, words = self._text.words[at], self._vocabulary
        if word in words.able and (able := find(words.able, self._text.words, at)):
            return self._able(at, able[1])
        if word in words.finishing and (end := self.end_mission(at)):
            return end
        return self._search_elsewhere(at) if word in words.asking["searching"] else 0

    def _search_elsewhere(self, at: int) -> int:
        """`look for the cup in the lab. If it isn't there, look in the hall`: for the same thing."""
        behind = run_start(self._tokens, len(self._tokens), JOINTS)
        if not behind or self._tokens[behind - 1].value != FAILS:
            return self._search_missing(at) if behind else 0
        search = next(filter(searches, reversed(self._tokens)), None)
        fetch = next((token for token in reversed(self._tokens) if token.kind == "command"), None)
        is_there = self._text.words[at + 1] in self._vocabulary.asking["located"]
        if is_there and search is None and fetch is not None and takes(fetch):
            words, done = self._text.span(at, at + 1), self._text.source.text[fetch.start : fetch.end]
            reason, advice = f"'{done}' is more than to look for it", "Say all that is to be done with it there."
            self._calls.problems.append(diagnostic("BT152", words, words=words.text, reason=reason, advice=advice))
        if search is not None or self._text.words[at] not in self._vocabulary.roles["try"]:
            return self._partial.add_further(search, at + 1) if search is not None else 0
        journey = self._journey() if self._context.read(PLACE, self._text, at + 1) is not None else None
        return self._partial.add_further(journey, at + 1) if journey is not None else 0  # `try the hall`

    def _search_missing(self, at: int) -> int:
        """`if Bob isn't in the lab, look in the hall`: for him."""
        located, last = self._vocabulary, run_start(self._tokens, len(self._tokens), JOINTS) - 1
        kinds, said = tuple(token.kind for token in self._tokens[last - 1 : last + 1]), self._tokens[last].value
        if kinds not in _DENIED or not isinstance(said, Called) or said.entry.id not in _WHERE:
            return 0
        if self._text.words[at + 1] not in located.asking["located"]:
            return 0
        kind = next(slot.type for slot in said.entry.slots if slot.type in (PERSON, OBJECT))
        pronoun = next(iter(pronouns_for(located.values.pronouns, kind)), "")
        match = self._partial.with_front(at, at + 1, [located.asking["search"][0], pronoun])
        if match is None:
            return 0
        self._partial.append(match, at)
        return match.last

    def _able(self, at: int, end: int) -> int:
        """`if you can pick it up, bring it to me`: picks it up unless it just has, and asks if that worked."""
        asked = self._phrase(at + 1)
        if asked is not None and asked.last > end:
            return self._begin_if(at)  # `if you can see it`
        match = self._phrase(end)
        if match is None or match.meaning.role != "command":
            match = self._partial.doing(end)
        if match is None or match.meaning.entry is None or self._text.words[match.last] != ",":
            return 0
        if not begins(self._tokens):
            return 0
        self._try(match, end, Token(WORKS, self._text.starts[at], self._text.ends[end - 1]))
        return match.last + 1

    def _begin_if(self, at: int) -> int:
        self._tokens.append(Token("if", self._text.starts[at], self._text.ends[at]))
        return at + 1

    def _try(self, match: Match, at: int, form: Token) -> None:
        """A command and the form that asks how it goes; without the command where it is the one before."""
        tokens, before = self._tokens, self._before(len(self._tokens))
        self._partial.append(match, at)
        if before is not None and tokens[before].value == tokens[-1].value:
            tokens.pop()
            go_on(tokens)
        else:
            tokens.append(Token("stop", form.start, form.start))
        tokens.append(form)

    def _unable(self, at: int) -> int:
        """`if you can't grab it`, behind a command about it: if that fails. Else it is tried first."""
        front, form = find(self._vocabulary.unable, self._text.words, at), len(self._tokens) - 1
        match = self._phrase(front[1]) if front is not None else None
        if front is not None and match is None:
            reaching = find(self._vocabulary.reaching, self._text.words, front[1])
            match = self._with_front(front[1], reaching[1], "journey") if reaching is not None else None
        if front is None or match is None or match.meaning.entry is None or match.meaning.entry.sort != "action":
            return 0
        asked, entry = {name for value in match.values for name in names_of(value.text)}, match.meaning.entry
        is_free = BRANCHES.isdisjoint(self._statement(form)[1])
        stop, is_new = self._text.ends[match.last - 1], form > 0 and self._tokens[form - 1].kind in STATEMENT_ENDS
        finds = self._text.words[front[1]] in self._vocabulary.asking["search"]
        command = asked_about(
            self._tokens,
            form,
            lambda token: is_about(token, asked, entry) or (finds and searches(token) and is_about(token, asked)),
        )
        if command is not None and is_free and is_new:
            return self._settle(command, form, stop, match.last)
        command = self._before(form) if form else None
        first = self._statement(command)[0] if command is not None else form
        about = [i for i in range(first, (command or first) + 1) if is_about(self._tokens[i], asked)]
        if about and is_free and is_new:
            form += 0 if self._is_tried(match.last) else self._pick_first(about[0], entry)
            return self._settle(about[0], form, stop, match.last)
        if command is not None and about:
            said = self._tokens[command]
            self._join(command, form, stop, True)
            return self._limit(said, match.last)
        if form and (not is_new or self._tokens[form - 1].kind != "newline"):
            return 0
        start = self._tokens.pop().start
        self._try(match, front[1], Token("or", start, self._text.ends[front[1] - 1], FAILS))
        command = len(self._tokens) - 3
        return self._behind_comma(self._tries_of(command, match.last) or self._limit(self._tokens[command], match.last))

    def _is_so(self, at: int) -> int:
        """`check if the door is open, and close it if it is`."""
        text, vocabulary = self._text, self._vocabulary
        is_end = text.words[at + 1] in vocabulary.asking["asking_be"] and self._is_end(at + 2)
        if not is_end or find(vocabulary.values.pronoun_words, text.words, at) is None:
            return 0
        form = self._tokens.pop()
        self._tokens.append(Token(WORKS, form.start, text.ends[at + 1]))
        self.trailing(at + 2)
        return at + 2

    def _name_fails(self, at: int) -> int:
        """`if delivery fails, A`: does what has this name, unless it just has, and A if it fails."""
        name = self._partial.named(at)
        fails = self._phrase(name.last) if name is not None else None
        if name is None or fails is None or fails.meaning.role != "fails":
            return 0
        tokens, form = self._tokens, self._tokens.pop()
        last = run_start(tokens, len(tokens), STATEMENT_ENDS)
        said = self._calls.token(name, at)
        if last and tokens[last - 1].kind == said.kind and tokens[last - 1].value == said.value:
            go_on(tokens)
            self._settle_command(last - 1)
        else:
            tokens += [said, Token("stop", form.start, form.start)]
        tokens.append(Token("or", form.start, self._text.ends[fails.last - 1], FAILS))
        return self._behind_comma(fails.last)

    def trailing(self, end: int) -> None:
        """Words behind a command that ask how the one before went, stand before it: `pick it up. Wave if that worked`.

        BT168 where the one before can't fail: `wave and say "done" if that worked`.
        """
        tokens, form, command = self._tokens, self._tokens[-1], len(self._tokens) - 2
        role = FAILS if form.value == FAILS else form.kind
        further = self._behind_comma(end)
        behind = self._phrase(further)
        is_last = self._is_end(end) or (behind is not None and behind.meaning.role == "otherwise")
        if not is_last or role not in (FAILS, WORKS, "if_possible") or tokens[command].kind not in _DONE:
            return
        first = run_start(tokens, command, JOINTS)
        said = tokens[first - 1] if first else None
        if said is None or (role == "if_possible" and may_fail(tokens[command])):
            return
        words = Span(self._text.source, form.start, form.end)
        form.kind = WORKS if role == "if_possible" else form.kind
        asks = said.kind == "condition" and first > 1 and tokens[first - 2].kind == "check"
        if first < command and (said.kind in _DONE or asks):
            if not (asks or may_fail(said)):
                self._unclear(words)
            at = tokens[command].start
            tokens[first:] = [Token("stop", at, at), form, tokens[command]]
        elif said.kind in STATEMENT_ENDS and tokens[statement_start(tokens, first - 1) - 1].kind != "define":
            done = tokens[command]
            del tokens[command:]
            go_on(tokens)
            asked = FAILS if role == FAILS else WORKS
            going = self.going_on(asked, words)
            tokens += [form if going == asked else Token(going, form.start, form.end), done]

    def found(self, match: Match, at: int) -> None:
        """`look for the key. When you find it, A, if not B`: with the `if not` it is `if that works`."""
        tokens, words = self._tokens, self._text.words
        as_soon_as = self._vocabulary.firsts["as_soon_as"]
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
            tokens += [Token("stop", form.start, form.start), Token(WORKS, form.start, form.end)]
