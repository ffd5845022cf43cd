"""What is done only if a command works: `find the key and bring it to me. If you can't find it, A`.

The condition is about the search alone, so that A isn't done where the key was found and could not be brought.
"""

from __future__ import annotations

from collections.abc import Callable, Container, Iterator, Sequence

from btlang.diagnostics.diagnostic import Diagnostic, diagnostic
from btlang.frontends.mission.explanations.times import lasting
from btlang.frontends.mission.token import (
    IN_CONDITIONS,
    JOINTS,
    RULES,
    STATEMENT_ENDS,
    Called,
    Listed,
    Token,
    arguments_of,
    constraint_of,
    drives,
    in_brackets,
    run_end,
    run_start,
    statement_end,
    statement_of,
    statement_start,
    texts_of,
)
from btlang.text.source import Source, Span
from btlang.text.words import Words
from btlang.vocabulary.antecedents import pronouns_for
from btlang.vocabulary.capabilities import HOLDING
from btlang.vocabulary.entry import Entry
from btlang.vocabulary.lexicon import Lexicon
from btlang.vocabulary.references import ALL, choice_of
from btlang.vocabulary.value_type import OBJECT, PERSON, PLACE

FAILS, WORKS = "if_fails", "if_works"
STAYS = "stays"
"""The role of a command with which the robot stays where it is then."""
IMPLIED = "implied"
"""The role of a search that nobody has asked for: `tell me where the cup is`."""
TURNED = "turned"
"""The role of an `otherwise` behind words about a failure."""
MEASURES = frozenset(("for", "up_to", "within", "count"))
"""What may stand between a command and the words that ask how it went."""
WAITS = ("wait_until", "wait_for", "wait_up_to")
"""The raw kinds before a condition that is waited for."""
_THERE = ("SeesObject", "ObjectIsAt")
HOLDS = "Holding"
"""The condition that holds once a thing is taken up."""
_SIMPLE = frozenset(("command", "name", "wait", "nothing", *JOINTS))
_COUNTED = _SIMPLE | MEASURES
_BETWEEN = _SIMPLE | STATEMENT_ENDS | MEASURES | {"open", "close", "meanwhile"}
_BRANCHED = _BETWEEN | IN_CONDITIONS | {"if", "unless", "otherwise"}
_HEADS = frozenset(("every", "every_day", "at", "repeat", "comma", "then", "colon", "open"))
"""What may stand before the first command of a statement."""
_OUTSIDE = frozenset(("define", "indent", "dedent"))


def asked_about(tokens: Sequence[Token], end: int, is_it: Callable[[Token], bool]) -> int | None:
    """The place of the latest command before one that words may ask about, out of brackets."""
    depth = 0
    for at in reversed(range(end)):
        depth += (tokens[at].kind == "close") - (tokens[at].kind == "open")
        if tokens[at].kind in _OUTSIDE or depth < 0:
            return None
        if depth:
            continue
        if tokens[at].role == IMPLIED:
            continue
        waits = tokens[at].kind == "condition" and at > 0 and tokens[at - 1].kind in WAITS
        if (waits or tokens[at].kind == "command") and is_it(tokens[at]):
            return at
    return None


def settle(tokens: list[Token], at: int, with_branches: bool = False) -> str:
    """Makes the tokens behind a command, up to the end, what is done if it works; the next token asks if it fails.

    Returns the role of that: "otherwise", or "if_fails" where nothing stands between, or "" where it isn't clear
    whether the rest belongs to the command, as it isn't with branches there. A statement before the command ends there.
    """
    end = run_start(tokens, len(tokens), STATEMENT_ENDS)
    first, behind = statement_start(tokens, at), run_end(tokens, at + 1, MEASURES)
    start = at - 1 if tokens[at].kind == "condition" else at
    before, rest = tokens[first:start], tokens[behind:end]
    timed = run_end(before, 1, JOINTS) if before[:1] != [] and before[0].kind == "at" else 0
    times, before = before[:timed], before[timed:]  # `at 9 am wait at the door for 5 min. If nobody comes, A`
    is_tried = before[:1] != [] and before[0].kind == "try"
    before = before[is_tried:]
    allowed = _BRANCHED if with_branches else _BETWEEN
    if any(token.kind not in allowed or token.value == FAILS for token in rest):
        return ""
    if not _sets_of(tokens[start:behind]).isdisjoint(text for token in rest for text in _texts(token)):
        return ""  # `find every cup and bring them to me`: the rest belongs to the round
    is_defined = first > 0 and tokens[first - 1].kind == "define"  # a definition in one line is one statement
    splits = _is_sequence(before) and not (is_defined and before)
    if not splits and not all(token.kind in _HEADS for token in before):
        return "" if rest else FAILS
    if not rest and not (splits and before):
        return FAILS
    here = tokens[at].end
    made = [*tokens[start:behind]]
    is_counted = is_tried and any(token.kind == "count" for token in tokens[at + 1 : behind])
    if is_counted:  # `try to get the cup up to 3 times, then bring it to me. If you can't grab it, A`
        made.insert(0, Token("retry", tokens[start].start, tokens[start].start))
    if rest:
        done = _one_statement(rest)
        if is_tried and not is_counted:
            done = [Token("open", here, here), Token("try", here, here), *done, Token("close", here, here)]
        made += [Token("stop", here, here), Token(WORKS, here, here), *done]
    elif is_tried and not is_counted:
        made.insert(0, tokens[first])
    if splits and before:
        joint = run_start(before, len(before), JOINTS)
        before = [*before[:joint], Token("semi", before[joint - 1].end, before[joint - 1].end)]
    tokens[first:end] = [*times, *before, *made]
    return "otherwise" if rest else FAILS


def turn_branches(tokens: list[Token]) -> None:
    """Make `A. If that fails, B. Otherwise C` into `A. If that works, C. Otherwise B`."""
    ends = JOINTS | STATEMENT_ENDS
    for at, token in enumerate(tokens):
        if token.kind != "otherwise" or token.role != TURNED:
            continue
        form = next(i for i in reversed(range(at)) if tokens[i].value == FAILS)
        end = statement_end(tokens, at)
        failing = tokens[form + 1 : run_start(tokens, at, ends)]
        working = tokens[at + 1 : run_start(tokens, end, STATEMENT_ENDS)]
        if not working:
            continue
        failing, working = (part[part[:1] != [] and part[0].kind == "comma" :] for part in (failing, working))
        here, there = tokens[form].start, token.start
        tokens[run_start(tokens, form, ends) : end] = [
            Token("stop", here, here), Token(WORKS, here, here), *working,
            Token("stop", there, there), Token("otherwise", there, token.end), *failing,
        ]  # fmt: skip


def with_rounds(tokens: list[Token]) -> None:
    """Make `go to the lab every hour and wave` into `every hour, go to the lab and wave`: a task has no end else."""
    for at, token in enumerate(tokens):
        if token.kind != "every":
            continue
        behind = run_end(tokens, at + 1, JOINTS)
        if all(each.kind != "and" for each in tokens[at + 1 : behind]):
            continue
        start, end = statement_of(tokens, at)
        first = run_end(tokens, max(run_start(tokens, at, _SIMPLE - {"then"}), start), JOINTS)  # behind `if C,`
        if first >= at:
            continue
        if any(each.kind not in _SIMPLE for each in tokens[behind:end]) and tokens[behind].kind != "if":
            continue
        if any(each.kind in ("every", "open", "colon") for each in tokens[behind:end]):
            continue
        value = tokens[at - 1].value
        if isinstance(value, Called | Listed) and not value.entry.accompaniment:
            here = tokens[first].start
            tokens[first : at + 1] = [token, Token("comma", here, here), *tokens[first:at]]


def with_goals_reached(tokens: list[Token]) -> None:
    """Make `walk through the hall until you reach the lab` go on to the lab: a journey is what ends the other one."""
    for at in (at for at in range(1, len(tokens) - 1) if tokens[at].kind == "until"):
        said, goal = tokens[at - 1].value, tokens[at + 1].value
        if drives(said) and drives(goal) and said.entry is goal.entry:
            tokens[at].kind = "then"


def with_either_end(tokens: list[Token]) -> None:
    """Make `A for 5 min or until C` the same as `for up to 5 min, A until C`, `wait 5 min [or] until C` likewise."""
    at = 0
    while at + 1 < len(tokens):
        at += 1
        until = at + (tokens[at].kind == "or" and tokens[at].value is None)
        if until + 1 >= len(tokens) or tokens[until].kind != "until":
            continue
        time, start = tokens[at - 1], tokens[at].start
        end = until + 1
        while end < len(tokens) and tokens[end].kind in IN_CONDITIONS - {"close"}:
            end += 1
        if until > at and time.kind in ("for", "up_to") and tokens[at - 2].kind in ("command", "name"):
            said = tokens[at - 2]
            limit = Token("up_to", said.start, said.start, time.value)
            comma, opening = Token("comma", said.start, said.start), Token("open", said.start, said.start)
            closing = Token("close", tokens[end - 1].end, tokens[end - 1].end)
            tokens[at - 2 : end] = [opening, limit, comma, said, *tokens[until:end], closing]
        elif time.kind == "wait":
            time.kind = "wait_up_to"
            del tokens[at : until + 1]
        elif time.kind == "close" and tokens[at - 2].kind == "wait":  # `wait at the door for 5 min or until C`
            tokens[at - 2].kind = "wait_up_to"
            tokens[at - 1 : end] = [*tokens[until + 1 : end], Token("close", start, tokens[end - 1].end)]


def with_watched_waits(tokens: list[Token]) -> None:
    """Let `wait 5 min. As soon as C, A` wait for C as long as that, and do A if C comes true in time."""
    for at, form in enumerate(tokens):
        last = run_start(tokens, at, STATEMENT_ENDS) if form.kind == "as_soon_as" else 0
        if not 0 < last < at or tokens[last - 1].kind != "wait":
            continue
        asked = tokens[at + 1 : run_end(tokens, at + 1, IN_CONDITIONS)]
        if asked:
            tokens[last - 1].kind, form.kind = "wait_up_to", "if"
            tokens[last:last] = [Token(each.kind, each.start, each.end, each.value, each.role) for each in asked]


def with_stays(tokens: list[Token], source: Source, standing: Container[str]) -> None:
    """Make `wait at the door. Whenever somebody comes near, wave` wait on there: else the rule would end at once.

    `standing` are the verbs that say so, `stand`.
    """
    if not any(token.kind in RULES for token in tokens):
        return  # as nearly always
    depth, outside = 0, list[int]()
    begins = True
    for at, token in enumerate(tokens):
        kind, value = token.kind, token.value
        if kind == "command" and not token.role and drives(value) and first_word(token, source) in standing:
            token.role = STAYS if names_place(value) else ""
        depth += (kind == "indent") - (kind == "dedent")
        ends = kind in STATEMENT_ENDS
        if depth == 0 and begins and not ends and kind != "define":
            outside.append(at)
        begins = ends
    commands = [at for at in outside if tokens[at].kind not in RULES]
    if len(commands) == len(outside) or not commands:
        return
    end = run_start(tokens, statement_end(tokens, commands[-1]), STATEMENT_ENDS)
    last = tokens[end - 1]
    constraint = constraint_of(tokens[commands[-1]])
    if last.kind == "nothing" and last.role == STAYS:
        last.kind = "wait_forever"
    elif last.role == STAYS:
        tokens[end:end] = [Token("then", last.end, last.end), Token("wait_forever", last.end, last.end)]
    elif constraint is not None and constraint.kind == "keep in" and end == commands[-1] + 1:
        tokens[end:end] = [Token("semi", last.end, last.end), Token("wait_forever", last.end, last.end)]


def find_brief_stays(tokens: Sequence[Token], vocabulary: Lexicon, source: Source) -> Iterator[Diagnostic]:
    """Report `wait at the door, then go to the lab`: without saying how long, it would leave at once; and `wait`."""
    waiting = vocabulary.asking["waiting"]
    for at, token in enumerate(tokens):
        if token.role == STAYS and first_word(token, source) in waiting:
            wait, behind = Span(source, token.start, token.end), run_end(tokens, at + 1, JOINTS | STATEMENT_ENDS)
            leaves = behind < len(tokens) and tokens[behind].kind == "command" and drives(tokens[behind].value)
            if leaves or (token.kind == "nothing" and wait.text.lower() in waiting):
                yield lasting(wait, vocabulary)


def find_unclear_things(tokens: Sequence[Token], vocabulary: Lexicon, text: Words) -> Iterator[Diagnostic]:
    """Report `pick up the cup. If the light is off, put it in the lab`: what is carried, or what was asked about."""
    carried, asked = "", ""
    pronouns = {*pronouns_for(vocabulary.values.pronouns, OBJECT)}
    if text.distinct.isdisjoint(pronouns):
        return
    for token in tokens:
        if token.kind in STATEMENT_ENDS:
            asked = ""
        value = token.value
        thing = _thing_of(value) if isinstance(value, Called) else ""
        if token.kind == "condition" and thing:
            asked = thing
        if token.kind != "command" or not thing or not takes(token):
            continue
        if carried not in ("", asked) and thing == asked:
            span = Span(text.source, token.start, token.end)
            pronoun = next((word for word in span.text.lower().split() if word in pronouns), "")
            if pronoun:
                yield diagnostic("BT151", span, words=pronoun, one=carried, other=asked)
        carried = "" if _is_delivered(value) else thing


def _is_delivered(said: object) -> bool:
    """Whether a command says to whom, or where to, it takes a thing: the hand is empty then."""
    return isinstance(said, Called) and any(said.entry.slot(name).type in (PLACE, PERSON) for name, _ in said.arguments)


def _thing_of(said: Called) -> str:
    """The name of the thing that a phrase is about, "" for none, or for one that is chosen."""
    return next((text for text in said.entry.given(OBJECT, said.arguments) if text[:1] != "{"), "")


def first_word(token: Token, source: Source) -> str:
    """The word with which a command begins, in small letters."""
    return source.text[token.start : token.end].split(" ")[0].lower()


def names_place(said: Called | Listed) -> bool:
    """Whether a command says a place: `stand at the desk`, but not `stop`."""
    return any(said.entry.given(PLACE, each) for each in arguments_of(said))


def _is_sequence(before: Sequence[Token]) -> bool:
    """Whether commands are done before another one, whatever they are joined with."""
    if any(token.kind not in _COUNTED for token in before) or all(token.kind in JOINTS for token in before):
        return not before
    if _sets_of(before):
        return False  # `visit every room and find the cup`: in each of them
    last = run_start(before, len(before), JOINTS)
    return 0 < last < len(before) and (drives(before[last - 1].value) or before[-1].kind != "and")


def _texts(token: Token) -> tuple[str, ...]:
    return texts_of(token.value) if isinstance(token.value, Called | Listed) else ()


def _sets_of(tokens: Sequence[Token]) -> set[str]:
    """The references to the things of the rounds that commands make."""
    choices = (choice_of(text) for token in tokens for text in _texts(token))
    return {f"{{{choice.key}}}" for choice in choices if choice is not None and choice.how == ALL}


def _one_statement(rest: Sequence[Token]) -> list[Token]:
    """The same commands joined by `then` where statements ended, with branches among them in brackets."""
    made: list[Token] = []
    if any(token.kind not in _BETWEEN for token in rest):
        first, end = run_end(rest, 0, JOINTS | STATEMENT_ENDS), run_start(rest, len(rest), JOINTS | STATEMENT_ENDS)
        return in_brackets(rest[first:end])
    for token in rest:
        if token.kind not in STATEMENT_ENDS:
            made += [] if token.kind in JOINTS and (not made or made[-1].kind == "then") else [token]
        elif made and made[-1].kind != "then":
            made.append(Token("then", token.start, token.start))
    return made


def is_about(token: Token, asked: set[str], entry: Entry | None = None) -> bool:
    """Whether a command is about the same things, and the one that an entry says."""
    value = token.value
    if not isinstance(value, Called | Listed) or not (asked or entry is not None):
        return False
    return (entry is None or value.entry.id == entry.id) and asked <= named_by(value)


def named_by(value: Called | Listed) -> set[str]:
    """What refers to the values of a command, with the nouns of what is chosen."""
    choices = [choice for text in texts_of(value) if (choice := choice_of(text)) is not None]
    nouns = {noun for choice in choices for part, noun in choice.parts if part in ("named", "kind")}
    return nouns.union(*(names_of(text) for text in texts_of(value)))


def names_of(text: str) -> set[str]:
    """What refers to the value of a port: its text, and the key of what is chosen."""
    choice = choice_of(text)
    return {text} if choice is None else {text, f"{{{choice.key}}}"}


def takes(command: Token) -> bool:
    """Whether a command takes something into a hand."""
    return isinstance(command.value, Called | Listed) and HOLDING in command.value.entry.needs


def misses(command: Token, asked: Token) -> bool:
    """`bring me the cup. If it isn't there, A`: whether a command fails where what it takes isn't there."""
    value, condition = command.value, asked.value
    if not isinstance(value, Called | Listed) or not isinstance(condition, Called) or not takes(command):
        return False
    things = {*condition.entry.given(OBJECT, condition.arguments)}
    return condition.entry.id in _THERE and bool(things) and things <= named_by(value)


def achieves(command: Token, asked: Token) -> bool:
    """Whether a condition holds once a command has succeeded: it is about the same things."""
    value, condition = command.value, asked.value
    if not isinstance(value, Called | Listed) or not isinstance(condition, Called):
        return False
    return condition.entry.id in value.entry.achieves and {text for _, text in condition.arguments} <= named_by(value)


def has_it(search: Token, asked: Token) -> bool:
    """`find the ball. Once you have it, A`: whether what was looked for is asked for as if it was held then."""
    said, value = asked.value, search.value
    if not isinstance(said, Called) or said.entry.id != HOLDS or not isinstance(value, Called | Listed):
        return False
    return {text for _, text in said.arguments} <= named_by(value)


def is_presence(value: object, somebody: Container[str]) -> bool:
    """Whether a condition is about somebody whom it doesn't name."""
    if not isinstance(value, Called) or any(slot.type == PERSON for slot in value.entry.slots):
        return False
    return any(word in somebody for phrase in value.entry.phrases[:1] for word in phrase.split())


def is_somebody_else(command: Token, asked: Token, somebody: Container[str]) -> bool:
    """Whether a condition asks for anybody, and the command before it is about one person."""
    value = command.value
    if not isinstance(value, Called) or not is_presence(asked.value, somebody):
        return False
    return any(text[:1] != "{" for text in value.entry.given(PERSON, value.arguments))
