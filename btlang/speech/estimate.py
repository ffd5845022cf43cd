"""An engine without sound: the words of a text share the time that it takes by its letters."""

from __future__ import annotations

from btlang.speech.engine import WORD, Phoneme, Settings, Utterance, words_at


class Estimate:
    """See btlang.speech.engine.SpeechEngine. Letters stand for their phonemes."""

    def __init__(self, settings: Settings) -> None:
        self._settings = settings

    def speak(self, text: str) -> Utterance:
        """At once."""
        begin, each = self._settings.text, self._settings.character
        seconds = begin + each * len(text)
        starts = [(match.start(), begin + each * match.start()) for match in WORD.finditer(text)]
        sounds = (
            Phoneme(letter.lower() if letter.isalpha() else "", begin + each * at) for at, letter in enumerate(text)
        )
        return Utterance(text, seconds, words_at(text, starts, seconds), (*sounds, Phoneme("", seconds)))
