"""Long missions to measure with: the lines that people write, in random order, and every one of them compiles."""

from __future__ import annotations

from random import Random

_NAMES = {
    "place": ("lab", "kitchen", "office", "living room", "lobby", "hall", "door"),
    "person": ("Alice", "Bob", "Carol"),
    "object": ("cup", "bottle", "red ball", "book"),
    "length": ("2 m", "half a meter", "30 cm", "1.5 meters", "a meter", "two and a half meters"),
    "angle": ("90 degrees", "45 degrees", "1 full turn"),
    "time": ("5 s", "2 seconds", "half a minute", "ten seconds", "500 ms"),
    "text": ('"Here I am."', "hello", '"The way is clear; I go on."', "sorry"),
    "percent": ("20%", "30 percent", "5%"),
    "count": ("twice", "3 times", "five times", "up to 10 times"),
}
_BASE = (
    "go to the {place}", "move forward {length}", "move back {length}", "turn left {angle}", "turn right",
    "turn around", "drive to {person}", "face the {object}", "walk to the {place}", "undock",
)  # fmt: skip
_FREE = (
    "wave at {person}", "nod", "look left", "look at the {object}", "raise your left arm", "print {text}",
    "point at the {place}", "shake your head", "open the hand", "look around", "wave to {person}",
)  # fmt: skip
_CONDITIONS = (
    "the battery is low", "the battery is below {percent}", "the path is clear", "there is a wall in front",
    "you are at the {place}", "{person} is near", "the robot is holding the {object}", "the battery is not full",
    "the distance to the {object} is less than {length}", "not bumped", "the robot is stuck",
    "the path is clear and the battery is not low", "bumped or there is something behind",
)  # fmt: skip
_LINES = (
    "{base}", "{base}.", "{free}", "Please {base}", "{base}, then {free}", "{base}, then {base} and {free}",
    "{base}, {free}, {base} and then {free}", "{free} and say {text}, then {base}", "{base} or say {text}",
    "if {condition}, {base}", "if {condition}, {base}, otherwise {free}", "{base} unless {condition}",
    "while {condition}, {base}", "{free} {count}", "repeat {base} until {condition}", "{base} within {time}",
    "try to {base}, otherwise say {text}", "wait {time}", "wait until {condition}", "({base} or {free}) {count}",
    "check that {condition}", "{base} provided that {condition}", "after {time}, {free}", "{base} if possible",
    "{free} every {time} for {time}", "retry {base} up to 3 times", "{name}", "{name}, then {free}",
    "{base}   # and so on", "pick up the {object}, then {base}", "go to the {place}, the {place} and the {place}",
)  # fmt: skip
_BLOCKS = (
    ("if {condition}:", "    {base}", "    {free}", "otherwise:", "    {base} then {free}"),
    ("repeat 3 times:", "    {base}", "    {free} and say {text}"),
    ("# the next part", "in parallel:", "    {base}", "    say {text}", ""),
    ("while {condition}:", "    {base}", "    if {condition}, {free}"),
)
_DEFINITIONS = (
    ("{new} is {base} then {free}",),
    ("{new} means {free}, then {base} and say {text}",),
    ("{new} means:", "    {base}", "    {free}", "    if {condition}, {base}"),
)
_ONE_BLOCK_IN, _ONE_DEFINITION_IN = 12, 150  # lines


class _Writer:
    def __init__(self, seed: int) -> None:
        self.random = Random(seed)
        self.names: list[str] = []

    def filled(self, pattern: str) -> str:
        """A pattern with something in each of its braces."""
        while "{" in pattern:
            before, _, rest = pattern.partition("{")
            kind, _, after = rest.partition("}")
            pattern = f"{before}{self._some(kind)}{after}"
        return pattern

    def _some(self, kind: str) -> str:
        patterns = {"base": _BASE, "free": _FREE, "condition": _CONDITIONS}.get(kind)
        if patterns is not None:
            return self.random.choice(patterns)
        if kind == "name":
            return self.random.choice(self.names) if self.names else "nod"
        if kind == "new":
            number = len(self.names)
            self.names.append(f"task x{chr(97 + number // 26 % 26)}{chr(97 + number % 26)}{'x' * (number // 676)}")
            return self.names[-1]
        return self.random.choice(_NAMES[kind])

    def group(self) -> tuple[str, ...]:
        """The lines of one statement."""
        if self.random.randrange(_ONE_DEFINITION_IN) == 0:
            return self.random.choice(_DEFINITIONS)
        if self.random.randrange(_ONE_BLOCK_IN) == 0:
            return self.random.choice(_BLOCKS)
        return (self.random.choice(_LINES),)


def mission(lines: int, seed: int = 1) -> str:
    """A text of so many lines (a few more where the last statement has several); the same for the same numbers."""
    writer = _Writer(seed)
    written: list[str] = []
    while len(written) < lines:
        written += map(writer.filled, writer.group())
    return "\n".join(written) + "\n"
