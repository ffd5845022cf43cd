"""What a keyword file declares: actions, conditions and the types of their slots."""

from __future__ import annotations

import re

from btlang.support.record import Record
from btlang.text.source import Span

TYPE_CHECKING = False
if TYPE_CHECKING:
    from collections.abc import Callable, Iterable
    from typing import Any, TypeAlias

    from btlang.vocabulary.ros_binding import RosBinding

    Verbs: TypeAlias = "tuple[tuple[tuple[str, ...], tuple[Role, ...]], ...]"
    """Verbs that mean the same, with their roles; then others."""


class SlotSpec(Record):
    """A slot of an entry: the name of its port, its type, and the port text that an absent value stands for.

    `otherwise` is the type that counts where no type is called `type`.
    """

    name: str
    type: str
    default: str | None = None
    otherwise: str = ""


COMPARISONS = ("below", "above", "at_least", "at_most", "equal")
"""The ports of a condition that compares a quantity; each holds the value to compare with."""
POINT = ("x", "y", "facing")
"""The ports of a point in the place of a place: metres, and degrees where it says them."""
MEASURED = "value"
"""The port of such a condition that may name the blackboard key to write what was measured to."""


FOUND = "found"
"""The output of a command that searches, where it takes a description of what it is to find: the name of that."""
THEME, RECIPIENT, GOAL, PATH, MANNER = "theme", "recipient", "goal", "path", "manner"
VIA = "via"
"""The slot of what a journey passes."""
SIDE = "side"
"""The type of sides of things: names that nothing is chosen of."""
UNMARKED = frozenset((THEME, MANNER, "extent", "duration"))
"""Roles that no word introduces."""
VERB_ROLES = (
    THEME, RECIPIENT, "beneficiary", "goal", "source", PATH, "location", "instrument", "topic", "extent", "duration",
    MANNER,
)  # fmt: skip
"""The roles that a verb may have."""


class Role(Record):
    """A role of a verb: the slot that its value fills, and the words that may introduce it.

    One that is `for_speaker` may be said as `me`, and then fills no slot.
    """

    name: str
    slot: str
    type: str
    words: tuple[tuple[str, ...], ...] = ()
    is_needed: bool = True
    for_speaker: bool = False

    @property
    def is_direct(self) -> bool:
        """Whether its value may stand without a word that introduces it."""
        return self.name in UNMARKED or self.name == RECIPIENT


SAY, COUNT = "Say", "Count"
"""The ids of the entries with which questions are answered: speech, and how many were counted."""


class Entry(Record, uncompared=("span",)):
    """One action or condition.

    `call` is "module:name" or the Python object itself; `phrases` are patterns, the first is the one printed back;
    `span` is the place of its first phrase in its keyword file. Where `measures` names a type, the `call` gives a
    quantity of it; the vocabulary makes the phrases that compare it of the `quantity` ones and the words for comparing.
    With the words that it is `named` by its value is said, and nothing compared: `say the answer`.
    An `accompaniment` can go along with other commands: speech, gestures, lights, driving and turning by a measure;
    every other action is a task, whose result counts. An action that `constrains` others ("keep out", "keep in" of a
    zone) holds over the statement that it is said in; it is a command of its own only where it stands alone. Of a list
    of places an action with `first` tries one after the other until it succeeds. `instant` and `uninterruptible` are
    what an action says of itself: that it ends in the tick in which it starts, and that it should not be halted
    half-way. Warnings are made of them; they change nothing in a run. With `thread` the `call`, a plain function, works
    in a thread of its own, beside the tick. An action that `touches` drives to contact on purpose, and so does a
    mission that waits for a condition that does, such as a bump. `ros` stands in place of `call` on a robot that speaks
    ROS 2. With `replaces` its `call` is what runs, whatever other entries of its id say, on any robot. `verbs` are
    verbs with their roles, from which the vocabulary makes the first of the `phrases`. `needs` names capabilities and
    parts of the robot (btlang.vocabulary.capabilities); what an action takes of them for itself is among its
    `resources`. `outputs` are the slots whose ports it writes. An action `achieves` the conditions with these ids:
    for its names they hold once it has succeeded. `denied` are phrases that say that a condition isn't so: `the cup is
    missing`. An entry that `yields` leaves its words to a mission, or
    another entry, that gives them a meaning. An entry without a `sort` has only phrases: those of a known id.
    """

    sort: str  # "action", "condition" or ""
    id: str
    phrases: tuple[str, ...]
    call: str | Callable[..., Any] = ""
    slots: tuple[SlotSpec, ...] = ()
    resources: tuple[str, ...] = ()
    topic: str = ""
    help: str = ""
    example: str = ""
    quantity: tuple[str, ...] = ()
    named: tuple[str, ...] = ()
    measures: str = ""
    accompaniment: bool = False
    constrains: str = ""
    first: bool = False
    instant: bool = False
    uninterruptible: bool = False
    thread: bool = False
    touches: bool = False
    ros: RosBinding | None = None
    replaces: bool = False
    needs: tuple[str, ...] = ()
    outputs: tuple[str, ...] = ()
    achieves: tuple[str, ...] = ()
    denied: tuple[str, ...] = ()
    yields: bool = False
    verbs: Verbs = ()
    span: Span | None = None

    def slot(self, name: str) -> SlotSpec:
        """Raises KeyError where the entry has no such slot."""
        for slot in self.slots:
            if slot.name == name:
                return slot
        raise KeyError(name)

    def given(self, type: str, arguments: Iterable[tuple[str, str]]) -> list[str]:
        """The texts that arguments give to slots of a type."""
        names = {slot.name for slot in self.slots if slot.type == type}
        return [text for name, text in arguments if name in names]

    @property
    def ports(self) -> tuple[str, ...]:
        """The names of the ports of its node: its slots, and those of what it measures."""
        return (*(slot.name for slot in self.slots), *((*COMPARISONS, MEASURED) if self.measures else ()))

    @property
    def needed_slots(self) -> frozenset[str]:
        """The slots that every phrase has, and no point stands for."""
        said = [frozenset(_SLOT.findall(_without_options(phrase))) for phrase in self.phrases]
        needed = said[0].intersection(*said[1:]) if said else frozenset[str]()
        return needed.difference(slot.name for slot in self.slots if self.point_ports and slot.type == "place")

    @property
    def point_ports(self) -> frozenset[str]:
        """The ports that take a point in the place of a place; none where the function takes only names."""
        ports = frozenset(slot.name for slot in self.slots if slot.name in POINT)
        return ports if ports.issuperset(POINT[:2]) else frozenset()

    @property
    def file(self) -> str:
        """Where it was declared."""
        return self.span.source.name if self.span else "Python"

    def slots_of(self, role: str) -> frozenset[str]:
        """The slots that a role of its verbs fills."""
        return frozenset(each.slot for _, roles in self.verbs for each in roles if each.name == role)


_SLOT, _OPTION = re.compile(r"\{(\w+)\}"), re.compile(r"\[[^\[\]]*\]")


def _without_options(phrase: str) -> str:
    """Leave out what may be left out of a phrase, also one option inside another one."""
    shorter = _OPTION.sub("", phrase)
    return phrase if shorter == phrase else _without_options(shorter)


class About(Record):
    """How a role is described to people: the topic it is listed under, what it does, and an example that runs."""

    topic: str = ""
    help: str = ""
    example: str = ""


class Meaning(Record):
    """What a phrase in the trie stands for: a connective or form of the language (`role`), or an entry.

    The role of an entry is "command" or "condition", or "negated" where the phrase says that a condition is not so.

    `value` is the number of rounds of words such as `twice`; `between` is the role that a connective has between
    commands, where that is another one; `node` is the id of a node that is said by its own words.
    """

    role: str
    entry: Entry | None = None
    value: int = 0
    between: str = ""
    node: str = ""
