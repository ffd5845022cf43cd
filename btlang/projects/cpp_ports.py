"""What C++ sources say of the ports of nodes: `providedPorts()`, and whether a node goes on without a port.

A small reader of the usual forms. What is written in another way is left out, so what isn't found means nothing.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator, Mapping, Sequence
from functools import cached_property

from btlang.diagnostics.files import read_bytes
from btlang.projects.files import find_files_below
from btlang.text.source import Source, Span
from btlang.tree.node import NodeModel, PortModel

_ENDINGS = (".hpp", ".h", ".hh", ".hxx", ".cpp", ".cc", ".cxx")
_TELLING = (b"Ports(", b"getInput", b"registerNodeType", b"registerBuilder", b"registerSimple", b"registerBehavior",
            b"registerScriptingEnum", b"RosNodePlugin", b"ActionNode", b"ConditionNode", b"ControlNode",
            b"DecoratorNode")  # fmt: skip
_COMMENT = re.compile(r'"(?:[^"\\\n]|\\.)*"|//[^\n]*|/\*.*?\*/', re.DOTALL)
_CLASSES = tuple(
    re.compile(  # a pattern that begins with a plain word is found much sooner
        rf"(?<!enum ){word}\s+(?:[A-Z_]+\s+)?(?P<name>\w+)\s*(?:final\s*)?"
        r"(?::(?!:)\s*(?:(?:public|protected|private|virtual)\s+)*(?P<base>[\w:]+)[^;{()]{0,500})?\{"
    )
    for word in ("class", "struct")
)
_MEMBER = re.compile(r"^(?:\w[^\n;={}()]*?[\s*&>:])??(?P<name>\w+)(?:<\w+>)?::~?\w+\s*\(", re.MULTILINE)
_PORT = re.compile(r"Port\s*(?:<([^;()\"]{0,300})>)?\s*\(\s*\"(\w+)\"")
_DIRECTIONS = {"Input": "input", "Output": "output", "Bidirectional": "inout"}
_READ = re.compile(r"getInput\s*(?:<[^;()\"]{0,300}>)?\s*\(\s*\"(\w+)\"[^;\"]{0,300}?\)(?=(\s*;)?)")
_FALL_BACK = tuple(
    re.compile(rf"{function}\b[^;\"]{{0,300}}\"(\w+)\"")
    for function in ("getInputOrBlackboard", "deconflictPortAndParamFrame")
)
_UNUSED = re.compile(r"([{};]\s*|\bif\s*\(\s*)(?:[\w:]+(?:::|\.|->))?$")
_TESTED = re.compile(r"\bif\s*\(\s*!\s*(?:[\w:]+(?:::|\.|->))?$")
_KEPT = re.compile(r"(\w+)\s*=\s*(?:this->)?$")
_BLOCK = re.compile(r"\s*\)\s*\{([^{}]*)\}")
_GIVES_UP = re.compile(r"\b(?:throw|return)\b")
_MOST_BEFORE = 80  # characters of the text before a call
_REGISTERED = (
    re.compile(r"register\w*\s*<\s*(?P<class>[\w:]+)[^;(\"]{0,300}>\s*\(\s*(?:\w+\s*,\s*)?\"(?P<id>[^\"]+)\""),
    re.compile(r"registerSimple\w+\s*(?P<class>)\(\s*\"(?P<id>[^\"]+)\""),
    re.compile(r"CreateRosNodePlugin\s*\(\s*(?P<class>[\w:]+)\s*,\s*\"(?P<id>[^\"]+)\""),
)
_KINDS = {"Condition": "Condition", "Action": "Action", "Decorator": "Decorator", "Control": "Control"}
"""Of nodes, by a word in the name of the class of the library from which theirs is made."""
_INSTANT = "SyncActionNode"
_REGISTERING = "registerScriptingEnum"
_ENUM = re.compile(r"registerScriptingEnum\s*\(\s*\"(\w+)\"")
_ENUMS = re.compile(r"registerScriptingEnums\s*<\s*(?:\w+::)*(\w+)\s*>|registerScriptingEnum\s*\(\s*[^\s\"]")
_ENUM_TYPE = re.compile(r"\benum\s+(?:class\s+|struct\s+)?(\w+)\s*(?::[^{;]*)?\{([^}]*)\}")
_ENUM_NAME = re.compile(r"(?:^|,)\s*(\w+)")


class _Class:
    """A class of C++, with what all its parts say: `spared` are ports without which it goes on, `needed` others that it
    reads.
    """

    def __init__(self, place: Span) -> None:
        self.place = place
        self.base = ""
        self.ports: dict[str, PortModel] = {}
        self.spared: set[str] = set()
        self.needed: set[str] = set()

    def read(self, text: str, start: int, end: int, place: Span) -> None:
        """Add what a part of the class says, which begins at a place."""
        for port in _PORT.finditer(text, start, end):
            direction = next((word for word in _DIRECTIONS if text.endswith(word, start, port.start())), "")
            if not direction:
                continue
            type, name = port.groups()
            given = list(_arguments(text, port.end(), end))
            default = given[0].strip('"') if len(given) > 1 else None
            if not self.ports:
                self.place = place
            self.ports.setdefault(name, PortModel(name, _DIRECTIONS[direction], (type or "").strip(), default))
        self.spared.update(match[1] for pattern in _FALL_BACK for match in pattern.finditer(text, start, end))
        for match in _READ.finditer(text, start, end):
            (self.spared if _goes_on(text, start, match) else self.needed).add(match[1])


def _goes_on(text: str, start: int, read: re.Match[str]) -> bool:
    """Return whether a class goes on without the port that it reads: it ignores the result, or has something else where
    that is none.
    """
    least = max(start - 1, read.start() - _MOST_BEFORE)
    before = _UNUSED.search(text, least, read.start())
    if before is not None and (before[1][0] == "i" or read[2] is not None):
        return True
    at = read.end() if _TESTED.search(text, least, read.start()) else -1
    if kept := _KEPT.search(text, least, read.start()):
        test = re.compile(rf"\s*;\s*if\s*\(\s*(!?)\s*{kept[1]}(?=\s*\))").match(text, read.end())
        if test is not None and not test[1]:
            return True
        at = test.end() if test is not None else -1
    block = _BLOCK.match(text, at) if at >= 0 else None
    return block is not None and _GIVES_UP.search(block[1]) is None


class CppSources:
    """The C++ sources in folders and below them, which are read when they are first asked for."""

    def __init__(self, folders: Sequence[str] = ()) -> None:
        self._folders = folders
        self._registering_enums: list[str] = []
        self._instant: set[str] = set()

    @cached_property
    def enums(self) -> tuple[frozenset[str], bool]:
        """Return the names of enums that scripts may use, and whether these are all that the folders have: sources may
        be written in another way, and a type that is registered as a whole may be elsewhere.
        """
        names: set[str] = set()
        types: set[str] = set()
        has_sources = any(path for folder in self._folders for path in find_files_below(folder, _ENDINGS))
        is_complete = bool(self._folders and (self.models or not has_sources))
        for text in self._registering_enums:
            names.update(match[1] for match in _ENUM.finditer(text))
            types.update(match[1] or "" for match in _ENUMS.finditer(text))
        for source in self._sources((b"enum",)) if types else ():
            for match in _ENUM_TYPE.finditer(_without_comments(source.text)):
                if match[1] in types:
                    types.discard(match[1])
                    names.update(_ENUM_NAME.findall(match[2]))
        return frozenset(names), is_complete and not types

    def is_instant(self, node_id: str) -> bool:
        """Return whether the class of a node says that it ends at once."""
        return node_id in self.models and node_id in self._instant

    @cached_property
    def models(self) -> Mapping[str, tuple[NodeModel, Span]]:
        """Return, by the ids of nodes, their ports, and where their classes are.

        A port that may be left out has a default. The kind is "" where the sources don't say it.
        """
        classes: dict[str, _Class] = {}
        registered: dict[str, tuple[str, Span]] = {}
        for source in self._sources():
            text = _without_comments(source.text)
            if _REGISTERING in text:
                self._registering_enums.append(text)
            for match in _find(_REGISTERED, text):
                place = Span(source, match.start(), match.end())
                registered[match["id"]] = (match["class"].rpartition(":")[2], place)
            heads = sorted(_find((*_CLASSES, _MEMBER), text), key=lambda head: head.start())
            ends = [head.start() for head in heads[1:]] + [len(text)]
            for head, end in zip(heads, ends, strict=False):
                place = Span(source, head.start(), head.end())
                found = classes.setdefault(head["name"], _Class(place))
                found.base = found.base or (head.groupdict().get("base") or "").rpartition(":")[2]
                found.read(text, head.end(), end, place)
        models = {}
        for name, found in classes.items():
            base = _line(name, classes)[-1].base
            if found.ports or ("Node" in base and any(word in base for word in _KINDS)):
                registered.setdefault(name, (name, found.place))
        for node_id, (name, place) in registered.items():
            line = _line(name, classes)
            kind = next((kind for word, kind in _KINDS.items() if line and word in line[-1].base), "")
            if not name:  # a function
                kind = "Condition" if "SimpleCondition" in place.text else "Action"
            if line and line[-1].base == _INSTANT:
                self._instant.add(node_id)
            models[node_id] = NodeModel(kind, node_id, tuple(_ports(line))), line[0].place if line else place
        return models

    def _sources(self, telling: Sequence[bytes] = _TELLING) -> Iterator[Source]:
        for folder in self._folders:
            for path in find_files_below(folder, _ENDINGS):
                try:
                    data = read_bytes(path)
                except OSError:
                    continue  # it isn't what the user asked about
                if any(word in data for word in telling):
                    yield Source(data.decode(errors="replace"), path)


def _without_comments(text: str) -> str:
    """Return a text of C++ with blanks in place of its comments."""
    return _COMMENT.sub(lambda match: match[0] if match[0][0] == '"' else " " * len(match[0]), text)


def _find(patterns: Iterable[re.Pattern[str]], text: str) -> Iterator[re.Match[str]]:
    return (match for pattern in patterns for match in pattern.finditer(text))


def _line(name: str, classes: Mapping[str, _Class]) -> list[_Class]:
    """Return a class and its bases, as far as they are in the sources."""
    line: list[_Class] = []
    while name in classes and classes[name] not in line:
        line.append(classes[name])
        name = line[-1].base
    return line


def _ports(line: Sequence[_Class]) -> Iterator[PortModel]:
    """Yield the ports of a class and its bases, without those that a nearer class has."""
    needed = {port for each in line for port in each.needed}
    spared = {port for each in line for port in each.spared} - needed
    if spared or needed:  # a port that isn't read is one that nobody needs
        listed = (port for each in line for port in each.ports.values())
        spared.update(port.name for port in listed if port.direction != "output" and port.name not in needed)
    ports = {port.name: port for each in reversed(line) for port in each.ports.values()}
    for port in ports.values():
        yield port.replace(default="") if port.default is None and port.name in spared else port


def _arguments(text: str, start: int, end: int) -> Iterator[str]:
    """Yield the further arguments of a call, behind the first one."""
    depth, begin, at = 0, -1, start
    while at < end:
        letter = text[at]
        if letter == '"':
            closing = re.compile(r'(?:[^"\\]|\\.)*"').match(text, at + 1)
            at = closing.end() if closing else end
            continue
        if letter in "([{":
            depth += 1
        elif letter in ")]}":
            depth -= 1
        if depth < 0 or (letter == "," and depth == 0):
            if begin >= 0:
                yield text[begin:at].strip()
            if depth < 0:
                return
            begin = at + 1
        at += 1
