"""How well the ears hear, on sentences and voices that they were not tuned on: the table of docs/ears.md."""

from __future__ import annotations

from collections.abc import Sequence

import pytest

from btlang.actions.conversation import MEANINGS, answers, meaning_of
from btlang.robots.bodies.body import Body, EarsSpec
from btlang.speech.pocketsphinx import PocketSphinx
from btlang.speech.recogniser import Expected, RecogniserSettings
from tests.profiles import amount, only_long
from tests.speech.measuring import Count, count, everything, heard, yes_or_no
from tests.speech.sounds import LIGHT, VOICES, guide, recorded

pytest.importorskip("pocketsphinx")

ALL, SOME = VOICES["test"], VOICES["test"][::2]
LOUD = (20.0, 15.0, 10.0, 5.0, 0.0)
OWN = ("good", "yes", "no")


def late(counted: Count) -> float:
    """Seconds from the end of speech within which 95 of 100 were understood."""
    return sorted(counted.late)[int(0.95 * len(counted.late))] if counted.late else 0.0


@only_long
@pytest.mark.parametrize("way", ["push", "wake"])
def test_when_it_is_spoken_to(way: str) -> None:
    sentences = count(("good",), guide(), ALL, LIGHT, way)
    yes_no = count(("yes", "no"), yes_or_no(), ALL, LIGHT, way)
    print(f"{way}: sentences {sentences.values} {sentences.part:.1f}%, late {late(sentences):.2f} s")
    print(f"{way}: yes and no {yes_no.values} {yes_no.part:.1f}%, late {late(yes_no):.2f} s")
    assert sentences.part >= 97.0
    assert yes_no.part >= 99.0
    assert max(late(sentences), late(yes_no)) < 0.5


@only_long
def test_when_it_listens_all_the_time() -> None:
    own = count(OWN, everything(), ALL, LIGHT, "always")
    foreign = count(("foreign",), everything(), ALL, LIGHT, "always")
    print(f"always: own {own.values} {own.part:.1f}%, late {late(own):.2f} s")
    print(f"always: foreign {foreign.values} {foreign.taken:.1f}%")
    assert own.part >= 75.0
    assert foreign.taken <= 10.0
    assert late(own) < 0.5


@only_long
def test_what_was_never_looked_at_before() -> None:
    """Lists and voices that came last, measured as they are: nothing was changed for them."""
    for voice in VOICES["confirm"]:
        for way in ("push", "wake"):
            sentences = count(("good",), guide(), (voice,), LIGHT, way, "confirm")
            yes_no = count(("yes", "no"), yes_or_no(), (voice,), LIGHT, way, "confirm")
            print(f"{voice.language} {voice.variant} {way}: {sentences.values}, yes and no {yes_no.values}")
        own = count(OWN, everything(), (voice,), LIGHT, "always", "confirm")
        foreign = count(("foreign",), everything(), (voice,), LIGHT, "always", "confirm")
        print(f"{voice.language} {voice.variant} always: own {own.values}, foreign {foreign.values}, {late(own):.2f} s")
        assert foreign.taken <= 10.0


@only_long
@pytest.mark.parametrize("decibels", LOUD)
def test_in_noise(decibels: float) -> None:
    pushed = count(("good",), guide(), SOME, decibels, "push")
    yes_no = count(("yes", "no"), yes_or_no(), SOME, decibels, "push")
    own = count(OWN, everything(), SOME, decibels, "always")
    foreign = count(("foreign",), everything(), SOME, decibels, "always")
    print(
        f"{decibels:g} dB: push {pushed.part:.0f}%, yes and no {yes_no.part:.0f}%, "
        f"always {own.part:.0f}%, foreign {foreign.taken:.0f}% {foreign.values}"
    )
    assert foreign.taken <= 10.0


YES = (
    "yes", "yeah", "yep", "sure", "yeah sure", "yes sure", "of course", "yes please", "okay", "certainly",
    "definitely", "absolutely", "certainly", "exactly", "yes of course", "yes", "yeah", "sure", "okay", "yes please",
)  # fmt: skip
NO = (
    "no", "no no", "nope", "no way", "not really", "not now", "not yet", "not at all", "no", "no thanks",
    "no thank you", "rather not", "I'd rather not", "of course not", "certainly not", "definitely not",
    "absolutely not", "not now", "that's wrong", "I don't want",
)  # fmt: skip


WRITTEN_YES = ("right", "correct", "that's right", "I do", "I would", "gladly", "why not", "please do")
WRITTEN_NO = ("nah", "never", "please don't", "wrong", "I wouldn't", "I would not", "I don't", "I do not")
"""What ears don't listen for."""


def signs(said: Sequence[str], wanted: str, decibels: float, expected: Expected) -> tuple[int, list[str]]:
    """How many answers were heard rightly, and those that were taken for the contrary."""
    ears, right, wrong = PocketSphinx(RecogniserSettings(push=True)), 0, list[str]()
    ears.expect(expected.replace(mode="pushed"))
    for text in said:
        for voice in VOICES["test"]:
            found, _ = heard(ears, recorded(text, voice, decibels, seed=len(text)), True)
            meaning = "" if found is None else meaning_of(found.text)
            right += meaning == wanted
            if found is not None and meaning in MEANINGS and meaning != wanted:
                wrong.append(f"{text} -> {found.text} ({decibels:g} dB, {voice.language} {voice.variant})")
    return right, wrong


@pytest.mark.long
@pytest.mark.parametrize("decibels", [30.0, 20.0, 10.0] if amount(0, 1) else [20.0])
def test_no_answer_is_taken_for_the_contrary(decibels: float) -> None:
    """200 answers by five voices in a long run; also where a robot waits for a yes alone."""
    count = amount(2, 20)
    right, refused = signs(NO[:count], "no", decibels, yes_or_no())
    more, agreed = signs(YES[:count], "yes", decibels, yes_or_no())
    alone = answers(("yes",), Body("ears", 0.2, ears=EarsSpec(3.0)))
    _, taken = signs(NO[: count // 2], "no", decibels, alone)
    print(f"{decibels:g} dB: {right + more} of {10 * count}, no as yes: {[*refused, *taken]}, yes as no: {agreed}")
    assert [*refused, *taken] == []
    assert len(agreed) <= (0 if decibels >= 20.0 else 3)
    assert right + more >= 0.95 * 10 * count


@pytest.mark.long
@pytest.mark.parametrize("decibels", [30.0, 20.0, 10.0] if amount(0, 1) else [20.0])
def test_a_refusal_that_is_not_listened_for_is_never_taken_for_a_yes(decibels: float) -> None:
    _, refused = signs(WRITTEN_NO[: amount(3, 20)], "no", decibels, yes_or_no())
    right, agreed = signs(WRITTEN_YES[: amount(1, 20)], "yes", decibels, yes_or_no())
    print(f"{decibels:g} dB: {right} of {5 * len(WRITTEN_YES)} other forms of yes heard, as no: {agreed}")
    assert refused == []
