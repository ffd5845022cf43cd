"""The engine `espeak`: libespeak-ng of the package espeakng-loader, which has a voice for each of many languages.

The library keeps its state in global variables, so there is one lock for it, and each text is spoken by a library that
was just loaded: else its times would depend, by a millisecond, on what was said before.
"""

from __future__ import annotations

import ctypes
from collections.abc import Iterator
from contextlib import contextmanager
from functools import lru_cache
from importlib.util import find_spec
from threading import Lock

from btlang.speech.engine import MissingEngine, Phoneme, Settings, SpeechError, Utterance, words_at

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any

_SYNCHRONOUS, _PHONEME_EVENTS, _DONT_EXIT = 2, 0x1, 0x8000
_UTF8, _CHARACTERS = 1, 1  # of the text, and what a position counts
_END, _WORD, _PHONEME = 0, 1, 7  # types of events
_RATE, _PITCH = 1, 3  # parameters
_QUIET = "_"  # the phonemes of pauses begin with it
_KEPT = 256  # utterances; a minute of sound is 2.6 MB
_LOCK = Lock()


class _Id(ctypes.Union):
    _fields_ = [("number", ctypes.c_int), ("name", ctypes.c_void_p), ("string", ctypes.c_char * 8)]


class _Event(ctypes.Structure):
    _fields_ = [
        ("type", ctypes.c_int), ("identifier", ctypes.c_uint), ("position", ctypes.c_int), ("length", ctypes.c_int),
        ("milliseconds", ctypes.c_int), ("sample", ctypes.c_int), ("user", ctypes.c_void_p), ("id", _Id),
    ]  # fmt: skip


_Callback = ctypes.CFUNCTYPE(ctypes.c_int, ctypes.POINTER(ctypes.c_short), ctypes.c_int, ctypes.POINTER(_Event))


class Espeak:
    """The engine `espeak`. Raises SpeechError if it isn't installed, or has no such voice."""

    def __init__(self, settings: Settings) -> None:
        if find_spec("espeakng_loader") is None:
            needs = "it needs the Python package espeakng-loader, which isn't installed"
            raise MissingEngine(f"{needs}: pip install 'btlang[voice]'")
        self._settings = settings
        with _LOCK, _library() as library:
            _set_up(library, settings)

    def speak(self, text: str) -> Utterance:
        """Speak the text literally, including what looks like markup. Recent texts are cached."""
        return _spoken(self._settings, text)


@lru_cache(maxsize=_KEPT)
def _spoken(settings: Settings, text: str) -> Utterance:
    if not text.strip():
        return Utterance(text, 0.0)
    samples, starts, phonemes = bytearray(), list[tuple[int, float]](), list[Phoneme]()

    def take(sound: Any, count: int, events: Any) -> int:
        if sound and count:
            samples.extend(ctypes.string_at(sound, 2 * count))
        for event in events:
            if event.type == _END:
                return 0
            if event.type == _WORD:
                starts.append((event.position - 1, event.sample / rate))
            elif event.type == _PHONEME:
                name = bytes(event.id.string).decode("utf-8", "replace")
                phonemes.append(Phoneme("" if name.startswith(_QUIET) else name, event.sample / rate))
        return 0

    # a NUL would end the text, and lone surrogates can't be written
    plain = text.replace("\0", " ").encode("utf-8", "replace")
    callback = _Callback(take)
    with _LOCK, _library() as library:
        rate = _set_up(library, settings)
        library.espeak_SetSynthCallback(callback)
        if library.espeak_Synth(plain, len(plain) + 1, 0, _CHARACTERS, 0, _UTF8, None, None):
            raise SpeechError("espeak-ng couldn't speak the text")
    seconds = len(samples) / 2 / rate
    return Utterance(text, seconds, words_at(text, starts, seconds), tuple(phonemes), bytes(samples), rate)


@contextmanager
def _library() -> Iterator[Any]:
    import _ctypes

    from espeakng_loader import get_library_path

    unload = getattr(_ctypes, "dlclose", None) or _ctypes.FreeLibrary  # type: ignore[attr-defined]
    try:
        library = ctypes.CDLL(get_library_path())
    except OSError as problem:
        raise SpeechError(f"libespeak-ng can't be loaded: {problem}") from None
    try:
        yield library
    finally:
        library.espeak_Terminate()
        unload(library._handle)


def _set_up(library: Any, settings: Settings) -> int:
    """Choose the voice; return the samples a second. Raises SpeechError."""
    import os

    from espeakng_loader import get_data_path

    data = get_data_path()
    rate = int(library.espeak_Initialize(_SYNCHRONOUS, 0, data.encode(), _PHONEME_EVENTS | _DONT_EXIT))
    if rate <= 0:
        raise SpeechError("espeak-ng can't read its data")
    variants = sorted(os.listdir(os.path.join(data, "voices", "!v")))
    if settings.variant and settings.variant not in variants:
        raise SpeechError(f'espeak-ng has no variant "{settings.variant}"; it has {", ".join(variants)}')
    name = "+".join(filter(None, (settings.language, settings.variant)))
    if library.espeak_SetVoiceByName(name.encode("utf-8", "replace")):
        raise SpeechError(f'espeak-ng has no language "{settings.language}"')
    library.espeak_SetParameter(_RATE, round(settings.speed), 0)
    library.espeak_SetParameter(_PITCH, round(settings.pitch), 0)
    return rate
