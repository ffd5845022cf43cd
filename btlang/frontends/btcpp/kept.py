"""What English doesn't say of an XML file, kept in comments at the end of its mission: for programs, not for readers.

Each line is a part of the file behind `#:`; a line that would be too long goes on behind `#::`.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator
from hashlib import sha256

from btlang.diagnostics.diagnostic import MissionError
from btlang.frontends.btcpp.fragments import Notes, fragment
from btlang.frontends.btcpp.models import ModelReader
from btlang.frontends.btcpp.origin import Element, XmlOrigin
from btlang.frontends.btcpp.scan import scanned
from btlang.frontends.btcpp.spelling import MODEL
from btlang.support.record import Record
from btlang.text.source import Source
from btlang.tree.comments import KEPT
from btlang.tree.node import NodeModel

TYPE_CHECKING = False
if TYPE_CHECKING:
    from btlang.frontends.btcpp.spelling import Pairs

_GOES_ON = f"{KEPT}:"
_WIDTH = 160  # characters of a line without its mark
_OWN = {"ID", "_name", "BTCPP_format", "main_tree_to_execute"}
"""Attributes that the writer sets itself."""
_FILE = "file"
_DIGEST = re.compile(rf'^({KEPT} <{_FILE} [^\n]*digest=")[0-9a-f]*', re.MULTILINE)
_NOTICE = "So that btc can write this onto its XML file again; don't change it."


class Kept(Record):
    """What was kept: `file` and `digest` of the XML that the mission was made from ("" where it was no file), the other
    attributes of <root> and of each BehaviorTree by its ID, and the parts with models.
    """

    file: str = ""
    digest: str = ""
    root: Pairs = ()
    trees: tuple[tuple[str, Pairs], ...] = ()
    parts: tuple[Element, ...] = ()
    models: tuple[NodeModel, ...] = ()


def digest_of(text: str) -> str:
    """By which a text is known again."""
    return sha256(text.encode(errors="surrogatepass")).hexdigest()[:16]


def parts_of(origin: XmlOrigin) -> Iterator[Element]:
    """What is to be kept of a file."""
    if origin.file:
        yield Element(_FILE, (("name", origin.file), ("digest", origin.digest)))
    if root := _others(origin.attributes):
        yield Element("root", root)
    for tree in origin.trees.values():
        if others := _others(tree.attributes):
            yield Element("BehaviorTree", (("ID", dict(tree.attributes).get("ID", "")), *others))
    for item in origin.items:
        if isinstance(item, Element) and item.tag == MODEL and item.items:
            yield item


def _others(attributes: Pairs) -> Pairs:
    return tuple(pair for pair in attributes if pair[0] not in _OWN)


def marked(lines: Iterable[str]) -> Iterator[str]:
    """Lines of XML as comments of a mission."""
    for at, line in enumerate(lines):
        if not at:
            yield f"{KEPT} {_NOTICE}"
        mark = KEPT
        line = line.replace("\r", "&#13;").replace("\n", "&#10;")  # of a description; as XML reads them back
        while line:
            yield f"{mark} {line[:_WIDTH]}"
            line, mark = line[_WIDTH:], _GOES_ON


def kept_in(text: str) -> Kept:
    """What a mission keeps; nothing where that is no longer XML."""
    if KEPT not in text:
        return Kept()
    lines: list[str] = []
    for line in text.replace("\r\n", "\n").split("\n"):
        if line.startswith(_GOES_ON) and lines:
            lines[-1] += line[len(_GOES_ON) + 1 :]
        elif line.startswith(KEPT):
            lines.append(line[len(KEPT) :])
    try:
        document = scanned(Source("\n".join(("<kept>", *lines, "</kept>"))))
    except MissionError:
        return Kept()
    notes = Notes(document)
    reader = ModelReader(document, notes)
    found: dict[str, Pairs] = {}
    trees: dict[str, Pairs] = {}
    parts: list[Element] = []
    models: list[NodeModel] = []
    for at in document.parts():
        part = fragment(document, notes, at)
        attributes = dict(part.attributes)
        if part.tag == MODEL:
            parts.append(part)
            models += [model for _, model in reader.read(at)]
        elif part.tag == "BehaviorTree":
            name = attributes.pop("ID", "")
            trees[name] = tuple(attributes.items())
        else:
            found[part.tag] = part.attributes
    file = dict(found.get(_FILE, ()))
    origin = file.get("name", ""), file.get("digest", ""), found.get("root", ())
    return Kept(*origin, tuple(trees.items()), tuple(parts), tuple(models))


def with_digest(text: str, digest: str) -> str:
    """A mission that was made from an XML file, for another state of that file."""
    return _DIGEST.sub(rf"\g<1>{digest}", text, count=1)
