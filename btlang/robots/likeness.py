"""What objects and people are like, and how a robot says that it sees nothing like that."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from itertools import chain

Parts = tuple[tuple[str, str], ...]


def of_object(kind: str, color: str, uses: tuple[str, ...]) -> Parts:
    """The parts by which an object can be described, in lower case."""
    named = [("color", _spelt(color)), ("kind", kind), *(("use", use) for use in uses)]
    return tuple((name, text.lower()) for name, text in named if text)


def of_person(wears: tuple[str, ...], gesture: str) -> Parts:
    """The same of a person: a red coat is a coat too."""
    clothes = (("clothing", text) for text in chain.from_iterable(map(_clothes, wears)))
    return tuple((name, text.lower()) for name, text in (*clothes, ("gesture", gesture)) if text)


def wears(worn: tuple[str, ...], parts: Mapping[str, str]) -> bool:
    """Whether one of the clothes has the colour and the name that are asked for."""
    wanted = {*_spelt(parts.get("color", "")).split(), *parts.get("clothing", "").split()}
    return not wanted or any(wanted <= {*_spelt(one.lower()).split()} for one in worn)


def unseen(kind: str, parts: Mapping[str, str], behind: str = "") -> str:
    """What is said where the robot knows nothing like that: `I haven't seen a red cup`; `behind` follows the thing."""
    if kind == "person" and "named" not in parts:
        return f"I don't see anybody{_person(parts)}{behind}"
    words = [parts[name] for name in ("color", "kind", "named") if name in parts]
    use = f" to {parts['use']}" if "use" in parts else ""
    if "named" in parts:
        return f"I know no {' '.join(words)}{use}{behind}"
    if "kind" not in parts:
        return f"I haven't seen {' '.join(('anything', *words))}{use}{behind}"
    return f"I haven't seen {_article(words[0])}{' '.join(words)}{use}{behind}"


def _person(parts: Mapping[str, str]) -> str:
    worn = [parts[name] for name in ("color", "clothing") if name in parts]
    waves = f" who is {parts['gesture']}" if "gesture" in parts else ""
    article = "" if "clothing" not in parts or worn[-1].endswith("s") else _article(worn[0])
    return (f" in {article}{' '.join(worn)}" if worn else "") + waves


def _article(word: str) -> str:
    return "an " if word[0] in "aeiou" else "a "


def _clothes(text: str) -> Iterator[str]:
    yield text
    if " " in text:
        yield text.split(" ", 1)[1]


def _spelt(color: str) -> str:
    return color.replace("grey", "gray")
