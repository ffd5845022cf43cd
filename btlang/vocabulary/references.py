"""References to values of the mission in port texts: `{level}` alone, or inside a text: `it is {level} percent`.

In a text `{{` and `}}` are the characters themselves.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Container, Iterable, Iterator, Mapping

from btlang.support.record import Record
from btlang.vocabulary.entry import POINT

SIZED = ("largest", "smallest")
PLACED = ("furthest", "leftmost", "rightmost")
SPEAKING = "speaking"
NEAREST, SEEN = "nearest", "seen"
CHOICES = (NEAREST, SEEN, "random", SPEAKING, *SIZED, *PLACED)
"""The ways to choose a name; "seen" is the nearest in view, else the nearest known; "speaking" is who spoke last. A
number is one more: "2" is the second one, "-1" the last.
"""
SOUGHT = "sought"
"""In place of such a way, for a command that searches: what fits the description needn't be known yet. In words and
references that is "nearest", of people "seen".
"""
ALL = "all"
"""In place of such a way: all names that are meant, one after the other. The part "count" says how many."""
COUNT = "count"
NAMES = "names"
"""The part of such a choice that lists its names itself, with a semicolon between them."""
Parts = tuple[tuple[str, str], ...]
"""What something is like, sorted: ("color", "red")."""
_PIECE = r"(?P<mark>\{\{|\}\})|\{(?P<name>[^{}]+)\}|(?P<text>[^{}]+|[{}])"  # compiled when a text needs it
PARTS = ("clothing", "color", "content", "gesture", "kind", "owner", "part", "size", "state", "use")
"""What a name can be described by."""
QUALITIES = ("content", "part")
"""The parts that stand behind a head, and lead to no other thing: the glass of water, the cup with a red lid."""
ADJECTIVES = ("size", "state", "color")
"""The parts that adjectives say, in the order in which they are said."""
_EVERYTHING = ("object", "person", "place")
RELATIONS: dict[str, tuple[str, ...]] = {
    "on": ("object",), "inside": ("object", "person", "place"), "at": ("object", "person"), "off": ("object",),
    "near": _EVERYTHING, "beside": _EVERYTHING, "behind": _EVERYTHING, "in_front_of": _EVERYTHING,
    "left_of": _EVERYTHING, "right_of": _EVERYTHING, "under": ("object", "place"), "above": ("object", "place"),
    "part_of": ("object", "place"), "between": _EVERYTHING, "other_than": _EVERYTHING, "seen_by": ("object", "person"),
    "held_by": ("object",),
}  # fmt: skip
"""How a thing may stand to another one that describes it, each with the types of things of which that can be said."""
SELF = "robot"
"""The robot itself, as what a relation leads to: the counter on its left."""
LATEST = "{}"
"""The latest value of the type, as what a relation leads to, until it is known which one that is: `another cup`."""
HOME = ("home", "")
"""The part of the place that is meant by the word for home."""
SECOND = "; and "
"""What stands between both things that something is between, and between the places where things of a set are."""
DENIED = {"not_color": "color", "not_kind": "kind", "not_size": "size", "not_state": "state"}
"""What a thing is said not to be, each with the type of the value; several values stand between semicolons."""
_NO_PARTS = ("type", "how", "output")  # the other ports of a choice


class Reference(Record):
    """A value of the mission, by its key on the blackboard."""

    key: str


class Choice(Record):
    """A value that is chosen when its command starts: the "nearest" or a "random" name of a type, put into a key.

    It has the `parts`, by their names. Its port text is one reference with a blank in it, which no key has:
    `{nearest person person}`, `{nearest object object|color=red|kind=cup}`.
    """

    how: str
    type: str
    key: str
    parts: Parts = ()

    @property
    def text(self) -> str:
        """The port text."""
        return f"{{{self.how} {self.type} {self.key}{''.join(f'|{name}={value}' for name, value in self.parts)}}}"


def ordinal(how: str) -> int:
    """The number that a way to choose is, from 1 on or from -1 back; 0 for any other way."""
    return int(how) if how.lstrip("-").isdecimal() else 0


def is_one(how: str) -> bool:
    """Whether a way to choose gives one name."""
    return how in CHOICES or ordinal(how) != 0


def names_key(key: str) -> str:
    """The key for the names of a set, one of which is in the other key in each round."""
    return f"{key}_names"


def free_key(kind: str, taken: Container[str]) -> str:
    """The key for what is chosen of a type: its name, or another one where the mission uses that itself."""
    key = kind
    while key in taken:
        key = f"chosen_{key}"
    return key


def choice_of(text: str) -> Choice | None:
    """The choice that a port text stands for."""
    if text[:1] != "{" or text[-1:] != "}" or " " not in text:
        return None
    first, *parts = text[1:-1].split("|")
    words = first.split(" ")
    if len(words) != 3 or not (words[0] == ALL or is_one(words[0])):
        return None
    named = (part.partition("=") for part in parts)
    return Choice(words[0], words[1], words[2], tuple((name, value) for name, _, value in named))


def is_related(text: str) -> bool:
    """Return whether a port text is a choice that another thing describes: `the cup on the table`."""
    choice = choice_of(text) if "|" in text else None
    return choice is not None and not RELATIONS.keys().isdisjoint(dict(choice.parts))


def choice_by(ports: Mapping[str, str]) -> Choice:
    """The choice that a node with these ports makes."""
    parts = ((name, text) for name, text in ports.items() if name not in _NO_PARTS)
    how = ports.get("how", ALL)
    if how == SOUGHT:
        how = SEEN if ports.get("type") == "person" else NEAREST
    return Choice(how, ports.get("type", ""), ports.get("output", "")[1:-1], tuple(sorted(parts)))


def pieces(text: str) -> list[str | Reference]:
    """What a text is made of: plain parts, as they will be, and references. Never two plain parts in a row."""
    if "{" not in text and "}" not in text:
        return [text] if text else []
    found: list[str | Reference] = []
    for match in re.finditer(_PIECE, text):
        if match["name"] is not None:
            found.append(Reference(match["name"]))
            continue
        plain = match["text"] or match["mark"][0]
        if found and isinstance(found[-1], str):
            found[-1] += plain
        else:
            found.append(plain)
    return found


def keys_in(text: str) -> Iterator[str]:
    """The keys that a port text refers to, in their order; what is chosen needs those that describe it."""
    if "{" in text:
        choice = choice_of(text)
        if choice is None:
            yield from (piece.key for piece in pieces(text) if isinstance(piece, Reference))
        else:
            yield from (key for _, part in choice.parts for key in keys_in(part))


def keys_set_in(text: str) -> list[str]:
    """The keys that a script sets, if a port text is one: `x := 1; y := x`."""
    return re.findall(r"([A-Za-z]\w*)\s*:=", text) if ":=" in text else []


def renamed(text: str, key: Callable[[str], str]) -> str:
    """The same text with each name in braces replaced by its key."""
    return re.sub(_PIECE, lambda match: f"{{{key(match['name'])}}}" if match["name"] is not None else match[0], text)


def plain(text: str) -> str:
    """The port text that stands for exactly this text."""
    return text.replace("{", "{{").replace("}", "}}")


def point_ports(text: str) -> tuple[tuple[str, str], ...]:
    """The ports of a point that was read as a value, () for any other value."""
    if text[:1] != "(":
        return ()
    return tuple(zip(POINT, re.findall(r"-?\d+(?:\.\d+)?(?:e[+-]?\d+)?", text), strict=False))


def key_of(words: Iterable[str]) -> str:
    """The key on the blackboard of a name of several words.

    `name` is another one in XML: as the port of a SubTree it would be the name of that node.
    """
    key = re.sub(r"\W", "_", "_".join(words))
    return key if key != "name" else "name_"
