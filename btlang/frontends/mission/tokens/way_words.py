"""What is done on a journey: `wave on the way`, `on the way to the lab, A`, `say hi every 5 s until you get there`."""

from __future__ import annotations

from btlang.frontends.mission.token import (
    JOINTS,
    LINES,
    RULES,
    STATEMENT_ENDS,
    Called,
    Listed,
    Token,
    constraint_of,
    in_brackets,
    run_start,
)
from btlang.frontends.mission.tokens.rule_words import RuleWords
from btlang.frontends.mission.tokens.rules_inside import ON_WAY
from btlang.frontends.mission.tokens.silent_words import BEGINS, begins
from btlang.vocabulary.match import Match


class WayWords(RuleWords):
    """Those of one text."""

    def _on_way(self, at: int, end: int) -> int:
        """`A, and on the way B`, `A and B on the way`: with the journey, before it if it is a task."""
        tokens, text = self._tokens, self._text
        if tokens[-1:] and tokens[-1].kind == "condition":
            return self._any_time(end, ON_WAY)  # `if the battery gets low on the way, A`
        if tokens and constraint_of(tokens[-1]) is not None and not self._is_end(end):
            return self._forbidden_on_way(end)
        if self._is_end(end):
            lasts = (
                text.source.text[text.starts[at] : text.ends[end - 1]]
                .lower()
                .startswith(self._vocabulary.word("until"))
            )
            return end if self._goes_along(lasts) else 0
        journey = self._journey()
        while journey is not None and tokens[-1].kind in LINES:
            tokens.pop()
        if journey is None or (tokens[-1].kind not in JOINTS and tokens[-1] is not journey):
            return 0
        behind = self._behind_comma(end)
        match = self._phrase(behind)
        if match is None or match.meaning.entry is None:
            return 0
        while tokens[-1].kind in JOINTS:
            tokens.pop()
        joint = self._joint(self._calls.token(match, behind))
        tokens.append(Token("after" if joint == "then" else joint, text.starts[at], text.ends[end - 1]))
        return behind

    def _forbidden_on_way(self, end: int) -> int:
        """`A. Avoid the hall on the way, and if C, B`: what is forbidden is so on A alone."""
        joint = self._phrase(self._behind_comma(end))
        if joint is None or joint.meaning.role != "and" or not self._goes_along():
            return 0
        self._tokens.append(Token("semi", self._text.starts[end], self._text.ends[joint.last - 1]))
        return joint.last

    def during(self, match: Match) -> int:
        """`A. Avoid the hall while doing so`. Return where to go on, 0 for other words."""
        is_last = self._tokens and constraint_of(self._tokens[-1]) is not None and self._is_end(match.last)
        return match.last if is_last and self._goes_along() else 0

    def _goes_along(self, lasts: bool = False) -> bool:
        """Joins the last command to the journey just before it, again and again if it `lasts` as long.

        A journey alone stays as it is.
        """
        tokens = self._tokens
        last = self._last_command()
        journey = self._journey(tokens[:last])
        if journey is None or constraint_of(tokens[last]) is not None:
            behind = run_start(tokens, last, STATEMENT_ENDS)
            if journey is not None and behind < last:  # `go to the lab. Avoid the hall on the way`
                tokens[behind:last] = [Token("and", tokens[last].start, tokens[last].start)]
            return bool(tokens) and tokens[-1].kind == "command" and self._journey() is not None
        first = last
        while tokens[first - 1].kind in JOINTS or tokens[first - 1].kind in LINES:
            first -= 1
        if tokens[last].kind != "command" or tokens[first - 1] is not journey:
            return False
        joint, start = self._joint(tokens[last]), tokens[last].start
        done = tokens[last:]
        if lasts and len(done) == 1:  # `wave until you arrive`
            done.insert(0, Token("repeat", start, start, role="doing"))
        if len(done) > 1:
            done = in_brackets(done)
        tokens[first:] = [Token("after" if joint == "then" else joint, start, start), *done]
        return True

    def _last_command(self) -> int:
        """The place of the last token, or that of the command which is done every so often: `say hi every 5 s`."""
        return len(self._tokens) - (2 if len(self._tokens) > 1 and self._tokens[-1].kind == "every" else 1)

    def _on_way_to(self, at: int, end: int) -> int:
        """What is done on the way to a place: a journey with it, behind it for a task, constrained by it."""
        tokens, text = self._tokens, self._text
        journey = self._with_front(at, end, "journey")
        if journey is None:
            return 0
        said = tokens[self._last_command()] if tokens else None
        if said is not None and said.kind in ("command", "name"):
            joint = "and" if constraint_of(said) is not None else self._joint(said)
            tokens.append(Token(joint, text.starts[at], text.ends[end - 1]))
            self._partial.append(journey, at)
            return journey.last
        behind = self._behind_comma(journey.last)
        match = self._phrase(behind)
        if match is not None and match.meaning.role in RULES and begins(tokens):
            tokens.append(Token("while_doing", text.starts[at], text.ends[end - 1]))
            self._partial.append(journey, at)
            tokens.append(Token("comma", text.starts[journey.last], text.starts[journey.last]))
            return behind
        if match is not None and match.meaning.role == "never":
            match = self._partial.forbidden(behind, match.last)
        if (tokens and tokens[-1].kind not in BEGINS) or match is None or match.meaning.entry is None:
            return 0
        following = self._calls.token(match, behind)
        joint = "and" if constraint_of(following) is not None else self._joint(following)
        if joint == "then":  # a task is done first
            tokens.append(Token("before", text.starts[at], text.ends[end - 1]))
            self._partial.append(journey, at)
            tokens.append(Token("comma", text.starts[journey.last], text.starts[journey.last]))
        else:
            self._partial.append(journey, at)
            tokens.append(Token(joint, text.ends[journey.last - 1], text.ends[journey.last - 1]))
        return behind

    def _joint(self, token: Token) -> str:
        """What joins a command to the journey on which it is done."""
        value = token.value
        goes_along = isinstance(value, Called | Listed) and value.entry.accompaniment
        return "meanwhile" if goes_along else "then"
