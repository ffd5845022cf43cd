"""The gestures of a robot as words: a keyword file that is made of them."""

from __future__ import annotations

import os
import re
from collections.abc import Iterator, Mapping
from functools import cache
from zlib import crc32

from btlang.diagnostics.diagnostic import MissionError
from btlang.diagnostics.files import read_source
from btlang.robots.bodies.body import Body
from btlang.robots.bodies.gesture import Gesture, joints_of
from btlang.robots.bodies.gesture_file import TARGET, GestureError, phrase_forms
from btlang.robots.files import DataFileError, as_mission_error, locate_problems
from btlang.text.source import Source
from btlang.text.toml import toml_key, toml_value
from btlang.text.toml_table import Problem
from btlang.tree.catalogue import CATALOGUE
from btlang.vocabulary.cache import own_folder
from btlang.vocabulary.entry import Meaning
from btlang.vocabulary.lexicon import Lexicon
from btlang.vocabulary.load import load_vocabulary
from btlang.vocabulary.pattern import Form, spelled
from btlang.vocabulary.shipped import shown_name
from btlang.vocabulary.word_tree import END, SLOTS

TYPE_CHECKING = False
if TYPE_CHECKING:
    from tempfile import TemporaryDirectory
    from typing import Any

TOPIC = "gestures"
"""The topic of words that a gesture with their phrase replaces."""
_CALL = "btlang.actions.gestures:perform"
_TARGETS = ("person", "object", "place")
_POINT = {"x": "length", "y": "length"}
_kept: list[TemporaryDirectory[str]] = []  # until the process ends


def gesture_words(body: Body) -> str | None:
    """Return the path of the keyword file, None for a body without gestures.

    Raises MissionError (BT076) for a phrase that means something else already.
    """
    if not body.gestures:
        return None
    path = os.path.join(_folder(), f"gestures-{crc32(body.file.encode(errors='replace')):08x}.toml")
    text = keyword_text(body)
    try:
        with open(path, encoding="utf-8") as file:
            is_new = file.read() != text
    except (OSError, UnicodeDecodeError):
        is_new = True
    if is_new:
        error = _problem(path, text)
        if error is not None:
            found = _clash(body, path, error)
            os.unlink(path)  # so that it is new again
            raise as_mission_error(found)
    return path


def _problem(path: str, text: str) -> MissionError | None:
    """Return why a text can't be the keyword file there."""
    from btlang.diagnostics.files import write_file  # only a file that is new is written

    write_file(path, text)
    try:
        load_vocabulary([path])
    except MissionError as error:
        return error
    return None


def keyword_text(body: Body) -> str:
    """Return the text of the file. Raises as `gesture_words` does."""
    english = load_vocabulary()
    entries, taken = [], list[str]()
    try:
        for gesture in body.gestures.values():
            for node_id, phrases in _by_id(gesture, english).items():
                taken += [node_id] if node_id in english.entries else []
                entries.append(_entry(body, gesture, node_id, phrases))
    except GestureError as error:
        raise as_mission_error(error) from None
    head = f"# The gestures of {toml_value(body.name)}, written from its robot file.\n"
    return head + f"replaces = {toml_value(list(dict.fromkeys(taken)))}\n" + "".join(entries)


def _clash(body: Body, path: str, error: MissionError) -> DataFileError:
    """Return the first phrase that can't be distinguished from another word, at its place in its gesture."""
    values = dict(error.diagnostics[0].arguments)
    one, other = values.get("first", ""), values.get("second", "")
    if values.get("first_file") != shown_name(path):
        one, other = other, one
    for gesture in body.gestures.values():
        if any(one in _add_targets(phrase) for phrase in gesture.phrases):
            alone = (body.replace(gestures={"": gesture.replace(phrases=(phrase,))}) for phrase in gesture.phrases)
            wrong = (index for index, each in enumerate(alone) if _problem(path, keyword_text(each)) is not None)
            index = next(wrong, 0)
            return _make_error(gesture, index, f'"{gesture.phrases[index]}" and "{other}" can match the same words')
    return GestureError(error.diagnostics[0].message, body.file)


def _make_error(gesture: Gesture, index: int, says: str) -> DataFileError:
    """Return the error for one of the phrases of a gesture."""
    problem = Problem(f"{says}; choose another phrase", "phrase", index)
    source = read_source(gesture.file) if gesture.file else Source("", gesture.name)
    return next(locate_problems([problem], source, source.name, GestureError))


def _entry(body: Body, gesture: Gesture, node_id: str, phrases: list[str]) -> str:
    slots: dict[str, Any] = {"movement": {"type": "text", "default": gesture.name}}
    is_aimed = any("{" in phrase for phrase in phrases)
    plain = next((phrase for phrase in phrases if re.fullmatch(r"[\w ]+", phrase)), "")
    values: dict[str, Any] = {
        "phrase": phrases, "id": node_id, "call": _CALL, "needs": [*_parts(body, gesture), *["pose"] * is_aimed],
        "topic": TOPIC, "help": gesture.help or f"Does the gesture {gesture.name}.", "example": plain,
        "slots": slots | (_POINT if any("{place}" in phrase for phrase in phrases) else {}),
    }  # fmt: skip
    return "\n[[action]]\n" + "".join(f"{toml_key(key)} = {toml_value(value)}\n" for key, value in values.items())


def _parts(body: Body, gesture: Gesture) -> list[str]:
    """Return the parts that a gesture moves."""
    both = [gesture, *([gesture.other] if gesture.other is not None else [])]
    names = {name for each in both for name in joints_of(each)}
    moved = (joint.part for joint in body.joints if joint.name in names)
    return list(dict.fromkeys((*moved, *(each.aim for each in both if each.aim))))


def _by_id(gesture: Gesture, english: Lexicon) -> Mapping[str, list[str]]:
    """Return the phrases of a gesture by the ids of their words: ids of known gestures, or a new one."""
    found: dict[str, list[str]] = {}
    for index, phrase in enumerate(gesture.phrases):
        for aimed in _add_targets(phrase):
            all_forms = phrase_forms(gesture.replace(phrases=(aimed,)))
            known = {_known(english, form, gesture, index) for form in all_forms} - {""}
            found.setdefault(next(iter(sorted(known)), _new_id(gesture.name, english)), []).append(aimed)
    return found


def _add_targets(phrase: str) -> Iterator[str]:
    """Return the forms of a phrase with each type of target."""
    slot = f"{{{TARGET}}}"
    return (phrase.replace(slot, f"{{{kind}}}") for kind in (_TARGETS if slot in phrase else _TARGETS[:1]))


def _known(english: Lexicon, form: Form, gesture: Gesture, index: int) -> str:
    """Return the id of the word that has a form of a phrase; "" for none. Raises GestureError if it isn't a gesture."""
    node: Any = english.trie
    for part in form:
        if isinstance(part, str):
            node = node.get(part)
        else:
            node = next((child for name, _, child in node.get(SLOTS, ()) if name == part.name), None)
        if node is None:
            return ""
    meaning: Meaning | None = node.get(END)
    if meaning is None or (meaning.entry is not None and meaning.entry.yields and meaning.entry.topic != TOPIC):
        return ""
    if meaning.entry is None or meaning.entry.topic != TOPIC:
        raise _make_error(gesture, index, f'"{spelled(form)}" has another meaning already')
    return meaning.entry.id


def _new_id(name: str, english: Lexicon) -> str:
    camel = "".join(word[:1].upper() + word[1:] for word in re.findall(r"[A-Za-z0-9]+", name))
    is_free = camel[:1].isalpha() and camel not in english.entries and camel not in CATALOGUE
    return camel if is_free else f"Gesture{camel or crc32(name.encode())}"


@cache
def _folder() -> str:
    """Return a folder that only the user writes to; for this process alone if there is none."""
    try:
        folder = os.path.join(own_folder(), "words")
        os.makedirs(folder, 0o700, exist_ok=True)
    except OSError:
        from tempfile import TemporaryDirectory  # it costs more than all the rest here

        _kept.append(TemporaryDirectory(prefix="btlang-"))
        return _kept[0].name
    return folder
