"""The recogniser `pocketsphinx`: English, on this computer, without a network."""

from __future__ import annotations

import math
import re
from collections.abc import Sequence
from importlib.util import find_spec

from btlang.speech.recogniser import RATE, Expected, Grammar, RecognisedSpeech, RecogniserError, RecogniserSettings

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any


_LETTERS = {
    "tch": "CH", "sch": "SH", "igh": "AY", "tion": "SH AH N", "ch": "CH", "sh": "SH", "th": "TH", "ph": "F", "ck": "K",
    "ng": "NG", "qu": "K W", "wh": "W", "kn": "N", "wr": "R", "ee": "IY", "ea": "IY", "ie": "IY", "oo": "UW",
    "ou": "AW", "ow": "OW", "ai": "EY", "ay": "EY", "ei": "AY", "ey": "IY", "oa": "OW", "oi": "OY", "oy": "OY",
    "au": "AO", "aw": "AO", "eu": "OY", "er": "ER", "ir": "ER", "ur": "ER", "ar": "AA R", "or": "AO R", "ce": "S EH",
    "ci": "S IH", "cy": "S IY", "a": "AE", "b": "B", "c": "K", "d": "D", "e": "EH", "f": "F", "g": "G", "h": "HH",
    "i": "IH", "j": "JH", "k": "K", "l": "L", "m": "M", "n": "N", "o": "OW", "p": "P", "q": "K", "r": "R", "s": "S",
    "t": "T", "u": "AH", "v": "V", "w": "W", "x": "K S", "y": "IY", "z": "Z",
}  # fmt: skip
_PIECE = re.compile("|".join(sorted(_LETTERS, key=len, reverse=True)))
_AT_THE_END = {"a": "AH", "o": "OW", "i": "IY", "u": "UW"}
_VOWEL = "aeiou"
_BRITISH = ((re.compile(r"\bOW\b"), "AH UW"), (re.compile(r"\bER$"), "AH"))
_WINDOW, _RATIO = 0.24, 0.9  # of the endpointer: seconds, and their part without speech that ends a sentence
_LONGEST = 10.0  # seconds of a sentence: what is longer is none, or the hall is loud
_BASE = math.log(1.0001)  # of the scores of a decoder
_VARIANT = re.compile(r"\(\d+\)$")
_SAME_PHONES, _SCORE, _CONSTANT = 15.5, 0.11, -1.7
"""The coefficients of a logistic regression over the training samples of tests/speech/ears,
with noise of 20 and 30 dB.
"""
_SURE = {"open": 1.0, "wake": -1.0, "addressed": -3.0, "pushed": -math.inf}
_UNSURE = {"open": -0.5, "wake": -2.0, "addressed": -6.0, "pushed": -math.inf}
"""The confidence from which a sentence is sure, and from which it is worth a question, by the mode of expectation."""


def guess_phones(word: str) -> str:
    """Return the phones of a word that no dictionary has, by its letters; "" for one without any."""
    letters = re.sub(r"(.)\1+", lambda match: match[0] if match[1] in "eo" else match[1], word.replace("'", ""))
    end = ""
    if len(letters) > 2 and letters[-1] == "e" and letters[-2] not in _VOWEL:
        letters = letters[:-1]
    elif len(letters) > 1 and letters[-1] in _AT_THE_END and letters[-2] not in _VOWEL:
        letters, end = letters[:-1], _AT_THE_END[letters[-1]]
    phones = " ".join(_LETTERS[piece] for piece in _PIECE.findall(letters))
    if letters.startswith("y") and phones.startswith("IY "):
        phones = f"Y {phones[3:]}"
    return f"{phones} {end}".strip()


def vary_accents(phones: str) -> list[str]:
    """Return other pronunciations of phones of American English: "no" and "never" in the south of England."""
    other = phones
    for pattern, said in _BRITISH:
        other = pattern.sub(said, other)
    return [] if other == phones else [other]


class PocketSphinx:
    """The recogniser `pocketsphinx`."""

    def __init__(self, settings: RecogniserSettings) -> None:
        if find_spec("pocketsphinx") is None:
            needs = "it needs the Python package pocketsphinx, which isn't installed"
            raise RecogniserError(f"{needs}: pip install 'btlang[ears]'")
        if settings.language.partition("-")[0] != "en":
            raise RecogniserError(f'pocketsphinx has no language "{settings.language}"; it has "en"')
        from pocketsphinx import Decoder, get_model_path

        phones = f"{get_model_path()}/en-us/en-us-phone.lm.bin"
        self._sentences = Decoder(lm=None, loglevel="FATAL", bestpath=False, beam=1e-80, pbeam=1e-80, wbeam=1e-60)
        self._phones = Decoder(lm=None, loglevel="FATAL", allphone=phones, lw=2.0, beam=1e-20, pbeam=1e-20)
        # it takes a second, in which nothing else of the process runs: before the robot moves, not at a question
        self._words = Decoder(loglevel="FATAL", fwdflat=False, bestpath=False, maxhmmpf=3000, maxwpf=5)
        self._push, self._endpointer = settings.push, self._new_endpointer()
        self._waiting = b""  # less than a frame of the endpointer
        self._spoken = bytearray()  # of the sentence under way
        self._known: dict[str, str] = {}
        self._expected, self._grammar = Expected(), Grammar(Expected())

    def expect(self, expected: Expected) -> None:
        spoken = bytes(self._spoken)
        self._stop()
        self._expected, self._grammar = expected, Grammar(expected)
        for word in self._grammar.words:
            self._learn(word)
        if expected.phrases:
            self._sentences.add_jsgf_string("expected", self._grammar.jsgf)
            self._sentences.activate_search("expected")
        if spoken:
            self._decode(spoken)

    def hear(self, samples: bytes) -> Sequence[RecognisedSpeech]:
        if not self._expected:
            self.forget()
            return []
        if self._push:
            self._decode(samples)
            return []
        found: list[RecognisedSpeech] = []
        samples, at, size = self._waiting + samples, 0, self._endpointer.frame_bytes
        while at + size <= len(samples):
            speech = self._endpointer.process(samples[at : at + size])
            at += size
            if speech:
                self._decode(speech)
            if self._spoken and not self._endpointer.in_speech:
                found += self.end()
            elif len(self._spoken) > _LONGEST * 2 * RATE:
                self.forget()
        self._waiting = samples[at:]
        return found

    def end(self) -> Sequence[RecognisedSpeech]:
        if not self._spoken:
            return []
        self._stop()
        if self._expected.phrases and (found := self._sentence()) is not None:
            return [found]
        text = _text(self._words) if self._expected.anything else ""
        return [RecognisedSpeech(text, False)] if text else []

    def forget(self) -> None:
        self._stop()
        self._waiting, self._endpointer = b"", self._new_endpointer()

    @property
    def confidence(self) -> float:
        """How sure it is that the sentence it found was said: about 0 if that is as likely as not."""
        sentence, phones = self._sentences.hyp(), self._phones.hyp()
        said = [each for each in self._sentences.seg() if each.word[0].isalpha()]
        frames = sum(each.end_frame - each.start_frame + 1 for each in said)
        if not frames or phones is None or not (sentence.score > 0 and phones.score > 0):
            return -math.inf
        wanted = [
            phone for each in said for phone in self._known.get(each.word, "").split() or self._phones_of(each.word)
        ]
        heard = [phone for phone in phones.hypstr.split() if phone != "SIL" and phone[0].isalpha()]
        score: float = (math.log(sentence.score) - math.log(phones.score)) / _BASE / frames
        return _SAME_PHONES * _likeness(wanted, heard) + _SCORE * score + _CONSTANT

    def _sentence(self) -> RecognisedSpeech | None:
        text = _text(self._sentences)
        if not self._grammar.holds(text):  # half a sentence
            return None
        confidence, mode = self.confidence, self._expected.mode
        if confidence < _UNSURE[mode]:
            return None
        return RecognisedSpeech(self._grammar.written(text), confidence >= _SURE[mode])

    def _phones_of(self, word: str) -> list[str]:
        return (self._sentences.lookup_word(word) or "").split()

    def _learn(self, word: str) -> None:
        """Add the pronunciation of a word that the dictionary lacks, by its letters."""
        if word in self._known:
            return
        phones = self._sentences.lookup_word(word)
        self._known[word] = phones or guess_phones(word)
        if phones is None:
            self._sentences.add_word(word, self._known[word], False)
        for number, other in enumerate(vary_accents(self._known[word])):
            name = f"{word}({9 - number})"
            self._known[name] = other
            self._sentences.add_word(name, other, False)

    def _active(self) -> list[Any]:
        decoders = [self._sentences, self._phones] if self._expected.phrases else []
        return [*decoders, self._words] if self._expected.anything else decoders

    def _decode(self, samples: bytes) -> None:
        begins = not self._spoken
        self._spoken += samples
        for decoder in self._active():
            if begins:
                decoder.start_utt()
            decoder.process_raw(samples)

    def _stop(self) -> None:
        if self._spoken:
            for decoder in self._active():
                decoder.end_utt()
            self._spoken.clear()

    def _new_endpointer(self) -> Any:
        from pocketsphinx import Endpointer

        return Endpointer(_WINDOW, _RATIO, sample_rate=RATE)


def _text(decoder: Any) -> str:
    found = decoder.hyp()
    words = found.hypstr.split() if found is not None else []
    return " ".join(_VARIANT.sub("", word) for word in words if word[0].isalpha())


def _likeness(one: Sequence[str], other: Sequence[str]) -> float:
    """Return the likeness of phones, from 0 to 1 for the same phones in the same order."""
    from rapidfuzz.distance import Levenshtein

    return float(Levenshtein.normalized_similarity(one, other))
