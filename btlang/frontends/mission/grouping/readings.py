"""Warnings about sentences with two readings that only the tokens show: the syntax tree no longer has what was said."""

from __future__ import annotations

from itertools import pairwise

from btlang.diagnostics.diagnostic import diagnostic
from btlang.frontends.mission.grouping.scan import ENDS, Scan
from btlang.frontends.mission.grouping.stack import StackEntry
from btlang.frontends.mission.token import Token
from btlang.text.source import Span

_COMMANDS = frozenset(("COMMAND", "TEST"))


def otherwise_of_another(scan: Scan, otherwise: Token) -> None:
    """BT050 for `if C, A. B. Otherwise D`, which joins B though the `if` could have it too."""
    entry, out = scan.stack[-1], scan.out
    if not entry.is_group or entry.latest is None or entry.latest >= len(out):
        return
    form = out[entry.latest]
    before = out[entry.latest : entry.begins]
    if form.kind != "FORM" or form.role not in ("if", "unless") or any(token.kind == "ELSE" for token in before):
        return
    do = next((at for at, token in enumerate(before, entry.latest) if token.kind == "DO"), None)
    if do is None or entry.begins >= len(out):
        return  # of a broken statement not all was made
    body = out[do + 1].start
    last = next(at for at in range(scan.at, len(scan.raw)) if scan.raw[at].kind in ENDS) - 1
    end = scan.raw[last].end
    first, middle = out[entry.begins].start, before[-1].start
    text = scan.source.text
    span = Span(scan.source, form.start, end)
    if "\n" in span.text:
        return
    kept, rest = text[first : scan.last_end], text[otherwise.end : end].strip(" ,")
    head, done = text[form.start : body], text[body:middle].strip(" .;")
    then, word = scan.word("then"), scan.word("otherwise")
    taken, other = f"({kept}) {word} {rest}", f"{head}({done} {then} {kept}) {word} {rest}"
    problem = diagnostic("BT050", span, taken=taken, other=other, fixed=f"{kept} {word} {rest}")
    scan.problems.append(problem.replace(readings=((span, f"{text[form.start : first]}{taken}"), (span, other))))


def _both_stopped(scan: Scan, token: Token) -> None:
    """BT050 for `A. B. Stop as soon as C`, which stops B though both could be meant."""
    entry, text = scan.around_statement()[0], scan.source.text
    if entry.commands is None or not entry.commands < entry.begins < len(scan.out):
        return
    first, last = scan.out[entry.commands].start, scan.out[entry.begins].start
    end = next(before.end for before, each in pairwise(scan.raw[scan.at :]) if each.kind in ENDS)
    span, stops = Span(scan.source, first, end), f"{scan.word('stop_when')} {text[token.end : end].strip()}"
    before = text[first : scan.last_end]
    if "\n" in before and not {"#", ":"}.isdisjoint(before):
        return
    before = "; ".join(line.strip() for line in before.splitlines() if line.strip())
    taken, other = f"({text[last : scan.last_end]}) {stops}", f"({before}) {stops}"
    problem = diagnostic("BT050", scan.span(token), taken=taken, other=other, fixed=taken)
    readings = (Span(scan.source, last, end), taken), (span, other)
    scan.problems.append(problem.replace(readings=readings))


def stopped(scan: Scan, token: Token) -> None:
    """`A then B. Stop as soon as C`: the whole statement before it is stopped."""
    _both_stopped(scan, token)
    scan.take_statement()


def waits_first(scan: Scan, entry: StackEntry) -> None:
    """BT171 at the end of the second statement of a group, if it has to wait for the first, `as soon as C, A`.

    Where it begins with `then`, that is what people mean.
    """
    begin, out = entry.latest, scan.out
    if begin is None or begin != entry.commands or max(begin, entry.begins) >= len(out):  # of broken ones nothing is
        return
    if out[begin].role != "as_soon_as":
        return
    made, second = out[begin : entry.begins - 1], out[entry.begins].start
    do = next((token.start for token in made if token.kind == "DO"), 0)
    before = scan.raw[next(at for at, token in enumerate(scan.raw) if token.start >= second) - 1]
    if not made or made[0].kind != "FORM" or not do or before.kind in ("then", "comma"):
        return
    text, word, end = scan.source.text, scan.span(made[0]), made[-1].end
    span, then = Span(scan.source, word.start, end), scan.word("then")
    condition, body = text[word.end : do].strip(" \t,"), text[do:end].lstrip(" \t,")
    if body.lower().startswith(f"{then} "):
        body = body[len(then) :].lstrip()
    wait, first = f"{scan.word('wait_until')} {condition}", f"{scan.word('first_time')} {condition}"
    readings: tuple[tuple[Span, str], ...] = ((word, scan.word("first_time")),)
    if "\n" not in span.text:
        wait, first = f"{wait} {then} {body}", f"{first}, {body}"
        readings = (span, wait), (span, first)
    problem = diagnostic("BT171", word, words=word.text, condition=condition, wait=wait, first=first)
    scan.problems.append(problem.replace(readings=readings))


def repeated(scan: Scan, token: Token) -> None:
    """BT172 for `do that` and `again` where more than one command stands before: `A then B. Do that 3 times`."""
    entry, of_rule = scan.around_statement()
    if of_rule or entry.commands is None or entry.mixed or entry.begins >= len(scan.out):
        return
    made = scan.out[entry.begins :]
    commands = [each for each in made if each.kind in _COMMANDS]
    text, first = scan.source.text, made[0].start
    statement, last = text[first : scan.last_end].rstrip(" ,"), commands[-1].start if commands else first
    if "\n" in statement or ")" in text[last : scan.last_end]:
        return
    end = next(each.start for each in scan.raw[scan.at + 1 :] if each.kind in ENDS)
    words = Span(scan.source, token.start, token.start + len(text[token.start : end].rstrip()))
    amount = text[token.end : words.end].strip()
    following = scan.raw[scan.at + 1]
    if token.kind == "again" or following.kind in ("again", "more"):
        more = str(following.value) if following.kind == "more" else "1"
        amount = f"{int(more) + 1} {scan.word('count')}" if more.isdigit() else ""
    if not amount:
        return
    span = Span(scan.source, first, words.end)
    taken = span, f"({statement}) {amount}"
    if len(commands) > 1:
        what = "the whole statement before it"
        other = span, f"{text[first:last]}({text[last : scan.last_end]}) {amount}"
    elif entry.commands < entry.begins:
        what, other = "only the statement before it", (words, f"{scan.word('everything')} {amount}")
    else:
        return
    _report_repeated(scan, words, what, taken, other)


def _report_repeated(scan: Scan, words: Span, what: str, taken: tuple[Span, str], other: tuple[Span, str]) -> None:
    problem = diagnostic("BT172", words, words=words.text, what=what, taken=taken[1], other=other[1])
    scan.problems.append(problem.replace(readings=(taken, other)))


def twice_more(scan: Scan, first: Token, amount: Token) -> None:
    """BT172 for `Repeat that twice`: three times in all, or two."""
    words, rounds = scan.span(first, amount), str(amount.value)
    that = scan.word("do_that")
    taken, other = f"{that} {rounds} {scan.word('more')}", f"{that} {scan.words(amount)}"
    what = f"what comes before it {rounds} times more, {int(rounds) + 1} times in all"
    _report_repeated(scan, words, what, (words, taken), (words, other))


def started_over(scan: Scan, token: Token, entry: StackEntry) -> None:
    """BT172 for `start over` behind several statements."""
    if entry.latest is None or entry.latest <= (entry.commands or 0):
        return
    start = next((each.start for each in scan.out[entry.latest :] if each.kind != "OPEN"), token.start)
    words, statement = scan.span(token), scan.source.text[start : scan.last_end].rstrip(" ,.")
    if "\n" in statement or ")" in statement:
        return
    taken = words, scan.word("everything")
    other = Span(scan.source, start, words.end), f"{scan.word('repeat')} {statement}"
    _report_repeated(scan, words, "all commands before it", taken, other)
