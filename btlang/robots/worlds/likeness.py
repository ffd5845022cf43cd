"""What objects and people are like, and how a robot says that it sees nothing like that."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from itertools import chain

Parts = tuple[tuple[str, str], ...]
SPEAKER = "me"
"""The owner of things that belong to whoever gives the robot its missions."""


def of_thing(
    kinds: Iterable[str],
    color: str,
    size: str,
    states: tuple[str, ...],
    owner: str,
    uses: tuple[str, ...] = (),
    content: str = "",
    having: tuple[str, ...] = (),
) -> Parts:
    """Return the parts by which an object or a place can be described, in lower case except for its owner."""
    several = (*(("state", state) for state in states), *(("use", use) for use in uses))
    pieces = (("part", text) for text in chain.from_iterable(map(_with_shorter, having)))
    of_kinds = (("kind", kind) for kind in kinds)
    named = [("color", _spelt(color)), *of_kinds, ("size", size), ("content", content), *several, *pieces]
    return (*((name, text.lower()) for name, text in named if text), *([("owner", owner)] if owner else []))


def kinds_of(name: str, kind: str) -> tuple[str, ...]:
    """Return the kinds that a name of several words says, and the declared one last: `parcel` of "big parcel", `room`
    and `meeting room` of "meeting room 1".
    """
    words = name.lower().split()
    is_numbered = words != [] and (not words[-1].isalpha() or len(words[-1]) == 1)  # `shelf B`
    named = words[:-1] if is_numbered else words
    heads = named[-1:] if named and named[-1].isalpha() and len(words) > 1 else []
    if heads and named is not words:
        heads.append(" ".join(named))
    declared = [kind.lower()] if kind else []
    return (*(head for head in dict.fromkeys(heads) if head not in declared), *declared)


def of_person(wears: tuple[str, ...], gesture: str) -> Parts:
    """Return the parts by which a person can be described: a red coat is a coat too."""
    clothes = (("clothing", text) for text in chain.from_iterable(map(_with_shorter, wears)))
    return tuple((name, text.lower()) for name, text in (*clothes, ("gesture", gesture)) if text)


def wears(worn: tuple[str, ...], parts: Mapping[str, str]) -> bool:
    """Return whether one of the clothes has the wanted colour and name."""
    wanted = {*_spelt(parts.get("color", "")).split(), *parts.get("clothing", "").split()}
    return not wanted or any(wanted <= {*_spelt(one.lower()).split()} for one in worn)


def unseen(kind: str, parts: Mapping[str, str], behind: str = "") -> str:
    """Return the sentence that the robot knows nothing like that: `I haven't seen a red cup`; `behind` follows the
    thing.
    """
    if kind == "person" and "named" not in parts:
        return f"I don't see {describe(kind, parts, behind)}"
    knows = "I know no" if "named" in parts else "I haven't seen"
    return f"{knows} {describe(kind, parts, behind, article='named' not in parts)}"


def describe(kind: str, parts: Mapping[str, str], behind: str = "", *, article: bool = True) -> str:
    """Return the words for what has these parts: `a red cup`, `anybody in red`; `behind` follows the thing."""
    if kind == "person" and "named" not in parts:
        return f"anybody{_person(parts)}{behind}"
    words = [parts[name] for name in ("size", "state", "color", "kind", "named") if name in parts]
    if "owner" in parts:
        behind = f" that belongs to {'you' if parts['owner'] == SPEAKER else parts['owner']}{behind}"
    use = f" to {parts['use']}" if "use" in parts else ""
    behind = f"{f' of {content}' if (content := parts.get('content')) else ''}{behind}"
    behind = f"{f' with {_article(part)}{part}' if (part := parts.get('part')) else ''}{behind}"
    if "kind" not in parts and "named" not in parts:
        words.insert(0, "anything")
    elif article:
        words[0] = _article(words[0]) + words[0]
    return f"{' '.join(words)}{use}{behind}"


def _person(parts: Mapping[str, str]) -> str:
    worn = [parts[name] for name in ("color", "clothing") if name in parts]
    waves = f" who is {parts['gesture']}" if "gesture" in parts else ""
    article = "" if "clothing" not in parts or worn[-1].endswith("s") else _article(worn[0])
    return (f" in {article}{' '.join(worn)}" if worn else "") + waves


def _article(word: str) -> str:
    return "an " if word[0] in "aeiou" else "a "


def _with_shorter(text: str) -> Iterator[str]:
    """Return the parts with shorter forms: a red lid is a lid, too."""
    yield text
    if " " in text:
        yield text.split(" ", 1)[1]


def _spelt(color: str) -> str:
    return color.replace("grey", "gray")
