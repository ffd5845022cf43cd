"""The tags of a URDF file with their lines, and what is no URDF."""

from __future__ import annotations

import re
from math import isfinite
from xml.parsers import expat

from btlang.robots.bodies.body_file import BodyError
from btlang.text.source import Source

TYPE_CHECKING = False
if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Sequence

_MOST = 1e6
_DECLARATION = re.compile(r"<\?xml[^>]*\?>")
_EXPRESSION = re.compile(r"\$\{[^}]*\}|\$\([^)]*\)")
_DECLARATIONS = ("xacro:arg", "xacro:property")  # harmless as long as only names have expressions
_EXPAND = "expand it first: xacro FILE > robot.urdf"
_OTHERS = {"sdf": "this is SDF, the format of Gazebo; give a URDF file"}


class UrdfElement:
    """A tag with its line, its own text and the tags inside."""

    def __init__(self, tag: str, attributes: dict[str, str], line: int) -> None:
        self.tag, self.attributes, self.line = tag, attributes, line
        self.inner: list[UrdfElement] = []
        self.text = ""

    def all(self, tag: str) -> list[UrdfElement]:
        """Return the tags of this kind directly inside."""
        return [element for element in self.inner if element.tag == tag]

    def first(self, tag: str) -> UrdfElement | None:
        """Return the first tag of this kind directly inside; None if there isn't any."""
        return next(iter(self.all(tag)), None)

    def below(self, *tags: str) -> Iterator[UrdfElement]:
        """Yield all tags of these kinds, however deep inside."""
        left = self.inner[::-1]
        while left:
            element = left.pop()
            left += element.inner[::-1]
            if element.tag in tags:
                yield element


class UrdfFile:
    """The root tag of a URDF or MJCF file, and the values of its tags. All methods raise BodyError with a line."""

    def __init__(self, source: Source) -> None:
        self._source = source
        self.has_expressions = False
        """Whether names had expressions of xacro, which are left out."""
        self.root = self._parse()
        if self.root.tag not in ("robot", "mujoco"):
            other = f"this isn't URDF: it begins with <{self.root.tag}>, not with <robot>"
            raise self.wrong(self.root, _OTHERS.get(self.root.tag, other))

    def _parse(self) -> UrdfElement:
        parser, stack, roots = expat.ParserCreate(), list[UrdfElement](), list[UrdfElement]()

        def start(tag: str, attributes: dict[str, str]) -> None:
            element = UrdfElement(tag, attributes, parser.CurrentLineNumber)
            if tag.startswith("xacro:") and tag not in _DECLARATIONS:
                raise self.wrong(element, f"this is xacro, which makes URDF: <{tag}> isn't URDF; {_EXPAND}")
            (stack[-1].inner if stack else roots).append(element)
            stack.append(element)

        def text(data: str) -> None:
            stack[-1].text += data

        def doctype(*_: object) -> None:
            raise self._wrong_at(parser.CurrentLineNumber, "a URDF file has no DOCTYPE; remove it")

        parser.StartElementHandler, parser.EndElementHandler = start, lambda tag: stack.pop()
        parser.CharacterDataHandler, parser.StartDoctypeDeclHandler = text, doctype
        # ROS reads a file whose declaration isn't its first line, and so do we
        written = _DECLARATION.sub(lambda match: " " * len(match[0]), self._source.text, count=1)
        try:
            parser.Parse(written.encode(errors="replace"), True)
        except expat.ExpatError as problem:
            says = expat.errors.messages.get(problem.code, "it can't be read")
            raise self._wrong_at(problem.lineno, f"this isn't XML: {says}") from None
        return roots[0]

    def name(self, element: UrdfElement, name: str) -> str:
        """Return an attribute that is a name, without expressions: launch files put prefixes there."""
        text = element.attributes.get(name, "")
        cleaned = _EXPRESSION.sub("", text).strip()
        self.has_expressions = self.has_expressions or cleaned != text.strip()
        if not cleaned:
            raise self.wrong(element, f'<{element.tag}> needs "{name}"')
        return cleaned

    def number(self, element: UrdfElement, name: str, usual: float | None = None) -> float:
        """Return an attribute that is a number, or the usual one if it isn't there."""
        return usual if usual is not None and name not in element.attributes else self._numbers(element, name, 1)[0]

    def vector(
        self, element: UrdfElement, name: str, usual: tuple[float, float, float] | None = None
    ) -> Sequence[float]:
        """Return an attribute of three numbers, or the usual ones if it isn't there."""
        return usual if usual is not None and name not in element.attributes else self._numbers(element, name, 3)

    def _numbers(self, element: UrdfElement, name: str, count: int) -> list[float]:
        text = element.attributes.get(name, "")
        if _EXPRESSION.search(text):
            raise self.wrong(element, f'this is xacro, which makes URDF: "{name}" is an expression; {_EXPAND}')
        try:
            found = [float(part) for part in text.split()]
        except ValueError:
            found = []
        if len(found) != count or not all(isfinite(value) for value in found):
            wanted = "a number" if count == 1 else f"{count} numbers"
            raise self.wrong(element, f'"{name}" of <{element.tag}> must be {wanted}')
        return [min(max(value, -_MOST), _MOST) for value in found]

    def wrong(self, element: UrdfElement, message: str) -> BodyError:
        """Return the error about a tag."""
        return self._wrong_at(element.line, message)

    def _wrong_at(self, line: int, message: str) -> BodyError:
        return BodyError(message, self._source.name, line, self._source)


def value_of(element: UrdfElement, names: tuple[str, ...], check: Callable[[float], bool]) -> float | None:
    """Return the first number in tags of these names, however deep inside, that passes; None if there isn't any."""
    for found in element.below(*names):
        try:
            value = float(found.text)
        except ValueError:
            continue
        if check(value):
            return value
    return None
