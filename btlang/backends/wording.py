"""Wording for a node that has no words yet: what people could say, made of its id and the names of its ports."""

from __future__ import annotations

import re
from collections.abc import Collection, Iterator, Mapping, Sequence

from btlang.support.record import Record

_AUXILIARIES = ("is", "are", "was", "were", "does", "did", "would", "should", "will")
_OWN = ("has", "have", "can")  # what the robot has and can do
QUESTIONS = (*_AUXILIARIES, *_OWN)
"""The words with which the id of a condition begins, where no model says that it is one."""
_CHECKING = ("check", "test", "verify")
_PLACING = (
    "not", "at", "in", "on", "near", "inside", "outside", "within", "below", "above", "over", "under", "behind", "from",
    "to", "of", "with",
)  # fmt: skip
_STATES = (
    "low", "high", "open", "full", "empty", "ready", "free", "near", "close", "far", "valid", "invalid", "on", "off",
    "ok", "safe", "stuck", "busy", "idle", "lost", "visible", "clear", "active", "present", "absent", "done", "true",
    "false", "running", "broken", "held", "shut",
)  # fmt: skip
_STATE_ENDINGS = ("ed", "able", "ible")
_PARTS = {
    **dict.fromkeys(("goal", "goal_pose", "target", "target_pose", "destination"), "to"),
    **dict.fromkeys(("start", "start_pose", "source"), "from"),
    **dict.fromkeys(("topic", "topic_name"), "on"),
    **dict.fromkeys(("frame", "frame_id", "frame_name"), "in frame"),
    **dict.fromkeys(("speed", "velocity"), "at speed"),
}
"""The words before what a port gives to a verb, by the name of the port."""


class SpokenPorts(Record):
    """The names of the ports that a phrase has slots for, in the order in which they are said.

    `texts` are those that take any text: a number or a flag alone doesn't say what it is for.
    """

    required: tuple[str, ...] = ()
    optional: tuple[str, ...] = ()
    outputs: tuple[str, ...] = ()
    texts: frozenset[str] = frozenset()


def id_words(name: str) -> list[str]:
    """Split an id: `GoToPose2` becomes go, to, pose, 2."""
    return [word.lower() for word in re.findall(r"[A-Z]+(?![a-z])|[A-Z]?[^\WA-Z\d_]+|\d+", name)]


def asks(node_id: str) -> bool:
    """Whether an id is worded as a question: `IsDoorOpen`."""
    return len(words := id_words(node_id)) > 1 and words[0] in QUESTIONS


def asks_or_checks(node_id: str) -> bool:
    """Whether an id is worded as a question, or says that something is checked: `CheckDoor`."""
    return asks(node_id) or id_words(node_id)[:1] in [[word] for word in _CHECKING]


def phrases(node_id: str, ports: SpokenPorts, articles: Collection[str], *, is_condition: bool) -> Iterator[str]:
    """Yield patterns for a leaf, the most natural first; the further ones are for words that mean something else
    already.
    """
    words = id_words(node_id)
    if not is_condition:
        starts: list[list[str]] = [[], ["run"], ["run", "node"]]
        for start in starts if set(words) - set(articles) else starts[2:]:
            yield " ".join([*start, *words, *_slots(words, ports, articles, _PARTS)])
            yield " ".join([*start, *words, *_slots(words, ports, articles)])
        return
    state = _state(words)
    if state is not None:
        subject, said = state
        about = _find_last_port(subject, ports.required)
        middle = [f"{{{about}}}"] if about else []
        others = tuple(port for port in ports.required if port != about)
        rest = ports.replace(required=others, texts=ports.texts if not about else frozenset())
        yield " ".join([*subject, *middle, *said, *_slots(said, rest, articles)])
    for more in ([], ["node"]):
        yield " ".join([*words, *more, *_slots(words, ports, articles), "succeeds"])


def _state(words: list[str]) -> tuple[list[str], list[str]] | None:
    """Return what a condition is about, and what is said about it: `IsDoorOpen` is `door`, `is open`. None for anything
    else.
    """
    if words and words[0] in _CHECKING:
        words = words[1:]
    if len(words) < 2:
        return None
    first, *rest = words
    if first in _OWN:
        return ["robot"], words
    if first in _AUXILIARIES:
        at = next((at for at, word in enumerate(rest) if word in _PLACING), len(rest) - 1)
        return rest[:at] or ["robot"], [first, *rest[at:]]
    *subject, last = words
    if last not in _STATES and not last.endswith(_STATE_ENDINGS):
        return None
    is_plural = re.search(r"[^suis]s$", subject[-1]) is not None
    return subject, ["are" if is_plural else "is", last]


def _slots(
    words: list[str], ports: SpokenPorts, articles: Collection[str], parts: Mapping[str, str] = {}
) -> Iterator[str]:
    """Yield the slots behind words. One needs no name: the one that the words end with, or a text that is the only
    one. Those with a part in what is done are said by its word, each word once, and none that the verb has.
    """
    said = {*words}

    def label(port: str) -> str:
        part = parts.get(port, "")
        if not part or part.split()[0] in said:
            return _label(port, words, articles)
        said.add(part.split()[0])
        return part

    bare = _find_last_port(words, ports.required)
    if not bare and len(ports.required) == 1 and ports.required[0] in ports.texts:
        [only] = ports.required
        bare = only if parts.get(only, words[-1]).split()[0] in said else ""
    if bare:
        yield f"{{{bare}}}"
    for port in ports.required:
        if port != bare:
            yield f"{label(port)} {{{port}}}"
    for port in ports.optional:
        yield f"[{label(port)} {{{port}}}]"
    for at, port in enumerate(ports.outputs):
        yield f"[{_label(port, words, articles) if at else 'giving'} {{{port}}}]"


def _find_last_port(words: list[str], ports: Sequence[str]) -> str:
    """Return the port whose name the words end with, "" if there is none."""
    return next((port for port in ports if words[-len(id_words(port)) or len(words) :] == id_words(port)), "")


def _label(port: str, words: list[str], articles: Collection[str]) -> str:
    """Return the words of a port, without those of the node that they begin with."""
    own = id_words(port)
    if own[: len(words)] == words and own[len(words) :]:
        own = own[len(words) :]
    return " ".join(own if any(word not in articles for word in own) else ["value", *own])
