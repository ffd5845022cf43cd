"""Feeds nonsense to all that reads missions: `python -m tests.fuzz [--minutes 10] [--seed N]`.

Texts of up to about 4 kB are bytes, soups of the words of the language, shuffled examples, deep nests and long lines.
Each goes through check with both parsers, explain, format and completion. A failure is an exception other than
MissionError, parsers that do not agree, or a step of more than one second; its seed and text are printed. The exit code
is 1 where there was one.
"""

from __future__ import annotations

import argparse
import random
import signal
import sys
import time
import traceback
from collections import Counter
from collections.abc import Callable
from functools import partial

from btlang.api import Mission
from btlang.cli.examples import examples
from btlang.diagnostics.diagnostic import MissionError
from btlang.frontends.mission.completion.completer import completions
from btlang.frontends.mission.reader import read_mission
from btlang.passes import compile_mission
from btlang.printer.layout import format_layout
from btlang.robots.mission_vocabulary import world_vocabulary
from btlang.text.source import Source

VOCABULARY = world_vocabulary()
LONGEST = 4000  # characters
SLOW = 1.0  # seconds
HANGS = 10  # seconds after which a step is broken off

_MARKS = (
    ",",
    ";",
    ":",
    "(",
    ")",
    ".",
    '"',
    "{",
    "}",
    "'",
    "-",
    "%",
    "/",
    "#",
    "\n",
    "\n  ",
    "\n    ",
    "\t",
    "\r\n",
    "\ufeff",
)
_VALUES = ("5", "5 m", "-1", "0.5 m", "1e9", "90 degrees", "20%", "3 times", "two", "half a meter", "2 s", "1e400", "٣")
_NAMES = ("x", "level", "counter", "someone", "patrol", "{x}", "{someone}", "{ level }", "{}", "{a}", '"it is {level}"')
_FORMS = (
    "patrol is", "greet {someone} is wave at {someone}", "greet", "greet Alice", "{x} means", "set x to", "set x to 3",
    "increase x by", "decrease {x}", "remember the battery as level", "remember", "as level", "for each place in",
    "for each x in the lab, the dock:", "go to {x}", "x is above 3", "the window is at (5, 1.5) facing 90 degrees",
    "whenever", "in parallel:", "try in order:", "repeat", "otherwise", "it", "there",
)  # fmt: skip
_STRANGE = "\0\x1b\u2028\u202e\u200b\U0001f600éßİǅ٣½“”«»’…\ud800\ufffd\xa0\x85"  # noqa: RUF001

_NESTS = (
    ("(", ")"), ("unless bumped, ", ""), ("try ", ""), ("if not (bumped and ", ")"), ("repeat (wave then ", ") twice"),
    ("for each x in the lab, the dock: ", ""), ("{", "}"), ("not ", ""), ("say {x} ", ""),
    ("if bumped wave otherwise ", ""),
)  # fmt: skip
_LINES = (
    "n{0} is n{1}", "set n{0} to n{1}", "p{0} {{a}} is p{1} {{a}}", "wvae n{0}", "remember {{n{1}}} as n{0}",
    'set n{0} to {0}\nsay "{{n{1}}}"', "n{0} is at ({0}, 1)\ngo to n{1}",
)  # fmt: skip


def _words() -> tuple[str, ...]:
    spoken = [entry.example for entries in VOCABULARY.entries.values() for entry in entries if entry.example]
    roles = [phrase for phrases in VOCABULARY.roles.values() for phrase in phrases]
    names = [name for kind in ("place", "person", "object") for name in VOCABULARY.values.names(kind)]
    return (*spoken, *" ".join(spoken).split(), *roles, *names)


_PIECES = (_words(), _MARKS, _VALUES, _NAMES, _FORMS)


def _bytes(choose: random.Random) -> str:
    return choose.randbytes(choose.randrange(400)).decode(choose.choice(("utf-8", "latin-1")), "replace")


def _strange(choose: random.Random) -> str:
    return "".join(choose.choice(choose.choice((_STRANGE, "wave is {x} ,\n"))) for _ in range(choose.randrange(200)))


def _soup(choose: random.Random) -> str:
    weights = [choose.random() for _ in _PIECES]
    kinds = choose.choices(_PIECES, weights, k=choose.choice((5, 20, 60, 400)))
    return choose.choice((" ", " ", "")).join(choose.choice(kind) for kind in kinds)


def _example(choose: random.Random) -> str:
    """A shipped mission with some of its words changed, moved or gone."""
    words = choose.choice(examples()).text.split(" ")
    for _ in range(choose.choice((1, 3, 10))):
        at = choose.randrange(len(words))
        words[at : at + choose.randrange(3)] = [choose.choice(choose.choice(_PIECES)), choose.choice(words)][
            : choose.randrange(3)
        ]
        words = words or ["wave"]
    return " ".join(words)


def _deep(choose: random.Random) -> str:
    opening, closing = choose.choice(_NESTS)
    depth = choose.randrange(1, LONGEST // len(opening + closing))
    if choose.random() < 0.2:
        lines = [f"{'  ' * level}{choose.choice(('repeat:', 'if bumped:', 'try:', 'p is:'))}" for level in range(60)]
        return "\n".join((*lines, "  " * 60 + "wave"))
    return (
        opening * depth
        + choose.choice(("wave", "bumped", "", "x"))
        + closing * choose.choice((depth, depth, depth - 1))
    )


def _long(choose: random.Random) -> str:
    pieces = [choose.choice(choose.choice(_PIECES)) for _ in range(choose.randrange(1, 4))]
    joint = choose.choice((" ", ", ", " and ", " then ", "", "\n"))
    return joint.join(pieces * (LONGEST // (len(joint.join(pieces)) + len(joint) or 1)))


def _alike(choose: random.Random) -> str:
    """Many lines of one form, each with a name of its own, some of them misspelt."""
    form = choose.choice(_LINES)
    return "\n".join(form.format(number, choose.randrange(60)) for number in range(60))


GENERATORS = (_bytes, _strange, _soup, _soup, _soup, _example, _example, _deep, _long, _alike)


def made(seed: int) -> str:
    """The text of a seed."""
    choose = random.Random(seed)
    return choose.choice(GENERATORS)(choose)[:LONGEST]


def _check(text: str, parser: str) -> object:
    try:
        reading = read_mission(Source(text), VOCABULARY, parser)
        return compile_mission(reading.mission, VOCABULARY)
    except MissionError as error:
        return str(error), error.diagnostics


def _explain(text: str) -> None:
    reading = read_mission(Source(text), VOCABULARY)
    tree = compile_mission(reading.mission, VOCABULARY)
    Mission(tree, VOCABULARY, syntax=reading.mission).explain()


def _format(text: str) -> None:
    compile_mission(read_mission(Source(text), VOCABULARY).mission, VOCABULARY, needs_command=False)
    once = format_layout(Source(text), VOCABULARY.orthography)
    assert format_layout(Source(once), VOCABULARY.orthography) == once, "a text that is laid out stays as it is"


def _complete(text: str, at: int) -> None:
    completions(text[:at], VOCABULARY)


class Hanging(BaseException):
    """A step does not end."""


def _break_off(*_: object) -> None:
    raise Hanging


def failures(text: str, at: int) -> list[tuple[str, str]]:
    """The steps that fail, each with what happened; `at` is where the text is completed."""
    found, told = [], []
    steps: dict[str, Callable[[], object]] = {
        "check": partial(_check, text, "shunting-yard"),
        "check with Lark": partial(_check, text, "lark"),
        "explain": partial(_explain, text),
        "format": partial(_format, text),
        "completion": partial(_complete, text, at),
    }
    for name, step in steps.items():
        began = time.perf_counter()
        signal.alarm(HANGS)
        try:
            result = step()
            told += [result] if name.startswith("check") else []
        except MissionError:
            pass
        except (Exception, Hanging):  # whatever it is, it must not happen
            found.append((name, traceback.format_exc(limit=-20)))
        finally:
            signal.alarm(0)
        took = time.perf_counter() - began
        if took > SLOW:
            found.append((name, f"it took {took:.1f} s"))
    if len(told) == 2 and told[0] != told[1]:
        found.append(("check", "the parsers do not agree"))
    return found


def main() -> int:
    parser = argparse.ArgumentParser(description="feeds nonsense to all that reads missions")
    parser.add_argument("--minutes", type=float, default=10.0)
    parser.add_argument("--seed", type=int, default=0, help="the first seed; the next text has the next one")
    options = parser.parse_args()
    signal.signal(signal.SIGALRM, _break_off)
    end = time.monotonic() + options.minutes * 60
    seed, failed = options.seed, Counter[str]()
    while time.monotonic() < end:
        text = made(seed)
        for step, what in failures(text, random.Random(seed).randrange(len(text) + 1)):
            failed[step] += 1
            print(f"seed {seed}, {step}: {what}\n{text!r}\n", flush=True)
        seed += 1
    print(f"{seed - options.seed} texts, {failed.total()} failures {dict(failed) or ''}".rstrip())
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
