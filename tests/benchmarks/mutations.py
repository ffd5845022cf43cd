"""Small mistakes in sound missions, and what btlang says of them.

    python -m tests.benchmarks.mutations [--count 200] [--seed 1] [--show]

Missions are the shipped examples, the good samples and the sentences of the documents. Each mutant is one of them with
one mistake, the kinds spread evenly. It is compiled with both parsers, as `btc check` does. Printed are how many ended
in a traceback, how many are refused, and of how many misspellings the first suggestion is the cure: the fix of the
first error, applied, gives the tree of the mission without the mistake. A slip that makes another word of English
(`ten` for `then`) is counted apart: such a word is never corrected.
"""

from __future__ import annotations

import argparse
import random
import re
import traceback
from collections import Counter
from collections.abc import Callable, Iterator, Sequence
from contextlib import suppress
from functools import cache
from pathlib import Path
from typing import NamedTuple

from btlang.cli.examples import examples
from btlang.diagnostics.diagnostic import Diagnostic, MissionError
from btlang.frontends.mission.reader import lexed, read_mission
from btlang.passes import compile_mission, errors_of
from btlang.robots.mission_vocabulary import world_vocabulary
from btlang.text.source import Source
from btlang.tree.dump import plain
from btlang.vocabulary.correct_words import correct_words
from btlang.vocabulary.lexicon import Lexicon

ROOT = Path(__file__).parent.parent.parent
PARSERS = ("shunting-yard", "lark")
_SENTENCE = re.compile(r'`([^`\n]+)`|-c "([^"\n]+)"|^    (\S.*)$', re.MULTILINE)
_BLOCK = re.compile(r"^```(?:\w+ [\w.]+|text)\n(.*?)^```$", re.MULTILINE | re.DOTALL)
_WORD = re.compile(r"[^\W\d_]{3,}")
_UNITS = ("m", "cm", "seconds", "minutes", "degrees", "%", "rad", "times")
_BESIDE = {near: row[at - 1] + row[at + 1] for row in (" qwertyuiop ", " asdfghjkl ", " zxcvbnm ")
           for at, near in enumerate(row) if near != " "}  # fmt: skip


class Mission(NamedTuple):
    """A sound mission: where it is from, its text, its world (None for the one that ships)."""

    name: str
    text: str
    world: str | None


class Mutant(NamedTuple):
    """A mission with one mistake; `where` says what was changed, `written` is what stands there now."""

    mission: Mission
    kind: str
    text: str
    where: str
    written: str


class Result(NamedTuple):
    """What became of a text: its tree, or what is wrong with it; `crash` is a traceback, "" where there is none."""

    tree: str | None
    problems: tuple[Diagnostic, ...]
    crash: str


@cache
def pool() -> tuple[Mission, ...]:
    """The missions that mistakes are made in, each once."""
    found = [Mission(e.name, e.text, str(ROOT / "examples" / e.world) if e.world else None) for e in examples()]
    samples = sorted((ROOT / "tests" / "samples" / "good").glob("*.txt"))
    found += [Mission(f"sample {path.stem}", path.read_text(encoding="utf-8"), None) for path in samples]
    for page in (ROOT / "README.md", *sorted((ROOT / "docs").glob("*.md"))):
        text = page.read_text(encoding="utf-8")
        told = [match[1] for match in _BLOCK.finditer(text)]
        told += [next(part for part in match.groups() if part) for match in _SENTENCE.finditer(text)]
        found += [Mission(page.name, part, None) for part in dict.fromkeys(told) if len(part.split()) > 2]
    return tuple({m.text: m for m in found if is_sound(m)}.values())


def is_sound(mission: Mission) -> bool:
    """Whether it compiles. What has unknown words doesn't, and to explain these takes most of the time."""
    with suppress(MissionError):
        tokens = lexed(Source(mission.text), vocabulary(mission.world)).tokens
        return all(token.kind != "unknown" for token in tokens) and compiled(*mission[1:]).tree is not None
    return False


@cache
def vocabulary(world: str | None) -> Lexicon:
    """The words of a world; loading them takes longer than to compile a mission."""
    return world_vocabulary(world=world)


def compiled(text: str, world: str | None = None, parser: str = PARSERS[0]) -> Result:
    """What one parser makes of a text."""
    try:
        mission = read_mission(Source(text), vocabulary(world), parser, errors_of=errors_of).mission
        return Result(plain(compile_mission(mission, vocabulary(world))), (), "")
    except MissionError as error:
        return Result(None, tuple(error.diagnostics), "")
    except Exception:  # whatever it is, it must not happen
        return Result(None, (), traceback.format_exc())


def checked(mutant: Mutant) -> Result:
    """What both parsers make of a mutant; that they do not agree is a crash too."""
    first, second = (compiled(mutant.text, mutant.mission.world, parser) for parser in PARSERS)
    if first != second and not first.crash:
        return Result(None, (), second.crash or "the parsers do not agree")
    return first


def mutants(count: int, seed: int, kinds: Sequence[str] = ()) -> Iterator[Mutant]:
    """So many mutants, of all kinds or of some, the same for the same seed."""
    kinds = kinds or list(KINDS)
    choose = random.Random(seed)
    made = 0
    while made < count:
        kind = kinds[made % len(kinds)]
        mission = choose.choice(pool())
        code = re.sub(r"#[^\n]*", lambda comment: " " * len(comment[0]), mission.text)
        change = KINDS[kind](code, choose)
        if change is not None:
            start, end, words = change
            text = mission.text[:start] + words + mission.text[end:]
            yield Mutant(mission, kind, text, f"{mission.text[start:end]!r} -> {words!r}", words)
            made += 1


Change = tuple[int, int, str] | None


def _dropped(text: str, choose: random.Random) -> Change:
    word = choose.choice(list(re.finditer(r"\S+[ ]?", text)))
    return word.start(), word.end(), ""


def _doubled(text: str, choose: random.Random) -> Change:
    word = choose.choice(list(re.finditer(r"\S+", text)))
    return word.start(), word.end(), f"{word[0]} {word[0]}"


def _swapped(text: str, choose: random.Random) -> Change:
    pairs = list(re.finditer(r"(?=(?<!\S)(\S+)([ ]+)(\S+))", text))
    if not pairs:
        return None
    first, gap, second = (pair := choose.choice(pairs)).groups()
    return pair.start(), pair.start() + len(first + gap + second), second + gap + first


def _misspelt(text: str, choose: random.Random) -> Change:
    """Two letters change places, one is left out, doubled, or becomes one beside it on the keyboard."""
    words = list(_WORD.finditer(text))
    if not words:
        return None
    word = choose.choice(words)
    letters = word[0]
    at = choose.randrange(len(letters) - 1)
    letter = letters[at]
    wrong = choose.choice(
        (
            letters[:at] + letters[at + 1] + letter + letters[at + 2 :],
            letters[:at] + letters[at + 1 :],
            letters[:at] + letter + letters[at:],
            letters[:at] + choose.choice(_BESIDE.get(letter.lower(), letter)).strip() + letters[at + 1 :],
        )
    )
    return (word.start(), word.end(), wrong) if wrong != letters else None


def _unpaired(text: str, choose: random.Random) -> Change:
    marks = list(re.finditer(r'[()"{}]', text))
    if not marks:
        return None
    mark = choose.choice(marks)
    return mark.start(), mark.end(), ""


def _other_unit(text: str, choose: random.Random) -> Change:
    units = list(re.finditer(r"(?<=\d)( ?)([a-z]+\b|%)", text))
    if not units:
        return None
    unit = choose.choice(units)
    other = choose.choice([word for word in _UNITS if word != unit[2]])
    return unit.start(), unit.end(), f" {other}"


KINDS: dict[str, Callable[[str, random.Random], Change]] = {
    "dropped": _dropped,
    "doubled": _doubled,
    "misspelt": _misspelt,
    "swapped": _swapped,
    "unpaired": _unpaired,
    "other unit": _other_unit,
}


def repaired(mutant: Mutant, problems: tuple[Diagnostic, ...]) -> str:
    """What the first suggestion does: "repairs it", "compiles, other tree", "still wrong" or "no suggestion"."""
    fix = next(problem for problem in problems if problem.is_error).fix
    if fix is None:
        return "no suggestion"
    span, words = fix
    text = mutant.text[: span.start] + words + mutant.text[span.end :]
    tree = compiled(text, mutant.mission.world).tree
    if tree is None:
        return "still wrong"
    return "repairs it" if tree == compiled(*mutant.mission[1:]).tree else "compiles, other tree"


def cure_of(mutant: Mutant, problems: tuple[Diagnostic, ...]) -> str:
    """As `repaired`, "another word" where the slip made one that is correct English and nothing repairs it."""
    is_right = mutant.written.lower() in correct_words(vocabulary(None).word_list)
    cure = repaired(mutant, problems)
    return "another word" if is_right and cure == "no suggestion" else cure


def _show(mutant: Mutant, problems: tuple[Diagnostic, ...], outcome: str) -> None:
    problem = next(problem for problem in problems if problem.is_error)
    fix = f"{problem.fix[0].text!r} -> {problem.fix[1]!r}" if problem.fix else "-"
    line = problem.span.source.line(problem.span.source.position(problem.span.start)[0])
    print(f"{outcome}: {mutant.where} in {mutant.mission.name}; {problem.code} proposes {fix} in: {line.strip()}")


def main() -> None:
    parser = argparse.ArgumentParser(description="small mistakes in sound missions")
    parser.add_argument("--count", type=int, default=200)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--show", action="store_true", help="the misspellings that are not repaired")
    options = parser.parse_args()
    outcomes: Counter[str] = Counter()
    cures: Counter[str] = Counter()
    for mutant in mutants(options.count, options.seed):
        result = checked(mutant)
        if result.crash:
            print(f"{mutant.where} in {mutant.mission.name}\n{mutant.text}\n{result.crash}")
        outcome = "traceback" if result.crash else "refused" if result.tree is None else "still a mission"
        outcomes[outcome] += 1
        if mutant.kind == "misspelt" and not result.crash:
            cure = "still a mission" if result.tree is not None else cure_of(mutant, result.problems)
            cures[cure] += 1
            if options.show and cure not in ("repairs it", "still a mission", "another word"):
                _show(mutant, result.problems, cure)
    print(f"{options.count} mutants of {len(pool())} missions, seed {options.seed}")
    print(", ".join(f"{outcomes[name]} {name}" for name in ("traceback", "refused", "still a mission")))
    right, wrong = cures["another word"], cures.total() - cures["still a mission"]
    shares = [
        f"{name} {cures[name]}" for name in ("repairs it", "compiles, other tree", "still wrong", "no suggestion")
    ]
    print(f"{cures.total()} misspellings, {cures['still a mission']} of them still a mission, {wrong} refused")
    print(f"the first suggestion: {', '.join(shares)}; {cures['repairs it'] / max(wrong, 1):.0%} repaired")
    share = cures["repairs it"] / max(wrong - right, 1)
    print(f"without the {right} that are other words of English: {share:.0%} repaired")


if __name__ == "__main__":
    main()
