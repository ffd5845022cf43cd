"""What btlang offers for a wrong letter, and for English that it does not know.

    python -m tests.benchmarks.corrections [--count 1200] [--seed 1] [--show]

The letters are those of `mutations`, one in a mission. The English is `english.txt`: sentences without a mistake whose
words are not in the vocabulary, so that a change of one of them would give it another meaning.
"""

from __future__ import annotations

import argparse
from collections import Counter
from pathlib import Path

from tests.benchmarks.mutations import checked, compiled, cure_of, mutants

ENGLISH = Path(__file__).with_name("english.txt")


def letters(count: int, seed: int, show: bool = False) -> Counter[str]:
    """What becomes of so many missions with a wrong letter that are refused, as `mutations.cure_of` says."""
    cures: Counter[str] = Counter()
    for mutant in mutants(count, seed, ("misspelt",)):
        result = checked(mutant)
        if result.tree is None:
            cure = "traceback" if result.crash else cure_of(mutant, result.problems)
            cures[cure] += 1
            if show and cure not in ("repairs it", "another word"):
                print(f"{cure}: {mutant.where} in {mutant.mission.name}")
    return cures


def offers() -> list[tuple[str, str]]:
    """The sentences of `english.txt` for which a change is offered, each with what it becomes."""
    found = []
    for line in ENGLISH.read_text(encoding="utf-8").splitlines():
        for problem in compiled(line).problems:
            if problem.fix is not None:
                span, words = problem.fix
                found.append((line, line[: span.start] + words + line[span.end :]))
    return found


def main() -> None:
    parser = argparse.ArgumentParser(description="corrections of letters, and of English that is not known")
    parser.add_argument("--count", type=int, default=1200)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--show", action="store_true", help="what is not repaired")
    options = parser.parse_args()
    cures = letters(options.count, options.seed, options.show)
    refused = cures.total() - cures["another word"]
    shares = (f"{name} {cures[name] / refused:.1%}" for name in ("repairs it", "compiles, other tree", "still wrong"))
    print(f"{options.count} wrong letters, {refused} refused and no other word of English: {', '.join(shares)}")
    print(f"{cures['another word']} made another word of English and get no offer")
    made = offers()
    sentences = ENGLISH.read_text(encoding="utf-8").splitlines()
    known = sum(compiled(line).tree is not None for line in sentences)
    print(f"{len(sentences)} sentences of English, {known} of them read, {len(made)} with an offer")
    for line, offered in made:
        print(f"  {line} -> {offered}")


if __name__ == "__main__":
    main()
