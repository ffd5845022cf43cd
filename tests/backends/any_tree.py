"""Random trees for hypothesis: every node type, known and unknown leaves, ports and names with any text."""

from __future__ import annotations

import re
from collections.abc import Sequence

from hypothesis import strategies as st

from btlang.tree.catalogue import CATALOGUE, SUBTREE
from btlang.tree.node import Node, NodeModel, PortModel, Tree

SHAPES = {node_id: (kind.least, min(kind.most, kind.least + 2)) for node_id, kind in CATALOGUE.items()}
"""How many children a node of each type has at least, and at most here."""
_INNER = [node_id for node_id, (_, most) in SHAPES.items() if most]
_NATURAL = ["Sequence", "Fallback", "Parallel", "IfThenElse", "Whenever", "Repeat", "ReactiveSequence", "WhileDoElse"]
_PHRASES = (
    ("Wave", ()),
    ("MoveForward", (("distance", "2"),)),
    ("GoTo", (("place", "kitchen"),)),
    ("GoTo", (("place", "no such place"),)),
    ("Say", (("text", "hello there"),)),
    ("TurnLeft", (("angle", "90"),)),
    ("Sleep", (("msec", "1500"),)),
    ("WaitForTime", (("time", "18:30"),)),
    ("WaitForTime", (("time", "9:05"),)),
    ("AlwaysSuccess", ()),
    ("AlwaysSuccess", (("_skipIf", "true"),)),
    ("AlwaysFailure", ()),
)
_CONDITIONS = (
    ("BatteryLow", ()),
    ("WallAhead", ()),
    ("Battery", (("below", "20"),)),
    ("Battery", (("below", "20.0"),)),
    ("ScriptCondition", (("code", "x == 'a' && y > 1"),)),
    ("IsPathValid", (("path", "{path}"),)),
)
_CODES = (
    "count := 3", "count := 3.0", "count := 'a'", "count += 2", "count -= 0.5", "count := level",
    "count := level * 1000", "count += level", "_2 := 'a' .. count", "_1 := count", "mood := 'it is'", "mood := ''",
    "mood := count", "mood := 'lab'", "goal := 'lab'", "goal := mood", "limit := 2", "the_mood := 1", "Mood := 1",
)  # fmt: skip
_COMPARED = ("count > 1 && count < 3", "count >= 1 && count <= 3", "mood == 'it'", "count == level")
_VALUES = (
    *(("Script", (("code", code),)) for code in _CODES),
    *(("ScriptCondition", (("code", code),)) for code in _COMPARED),
    ("Battery", (("value", "{level}"),)),
    ("Battery", (("below", "{level}"),)),
    ("Battery", (("below", "20"), ("value", "{level}"))),
    ("DistanceToPlace", (("place", "{goal}"), ("value", "{gap}"))),
    ("Say", (("text", "{mood}"),)),
    ("Say", (("text", "{_1}"),)),
    ("Say", (("text", "a {b"),)),
    ("Say", (("text", "{{count}}"),)),
    ("MoveForward", (("distance", "{limit}"),)),
    ("GoTo", (("place", "{goal}"),)),
    ("GoToPerson", (("person", "{who}"),)),
    ("Sleep", (("msec", "{count}"),)),
    ("WaitForTime", (("time", "{goal}"),)),
    ("GoTo", (("place", "{charging_spot}"),)),
    ("GoTo", (("place", "{My.Key}"),)),
    ("GoTo", (("place", "{Goal}"),)),
    ("Wave", (("person", "{charging_spot}"),)),
    ("TurnLeft", (("angle", "{a}"),)),
    ("MoveForward", (("distance", "{gap}"), ("speed", "{limit}"))),
    ("DistanceToPlace", (("place", "{goal}"), ("below", "{gap}"))),
)
_COMPUTED = (
    (("_1 := 'a ' .. count",), "Say", "text"),
    (("_2 := mood .. who .. stop",), "Say", "text"),
    (("_1 := 'x'", "_2 := _1 .. ''"), "Say", "text"),
    (("_1 := count * 1000",), "Sleep", "msec"),
    (("_3 := count * 1000",), "Sleep", "msec"),
    (("_1 := 'to ' .. goal",), "GoTo", "place"),
)
MODELS = (
    NodeModel("Condition", "IsPathValid"),
    NodeModel("Action", "FollowPath", (PortModel("a", "output"), PortModel("goal_pose", "output"))),
)
_OWN_LEAVES = (
    "FollowPath", "open_gripper", "2fast", "Do It", "IsOk", "Then", "tür", "A", "OpenBox", "CheckDoor", "GraspObject",
    "ApproachShelf", "PickAndPlace", "WaveTwice", "GoTo",
)  # fmt: skip
texts = st.one_of(
    st.sampled_from(
        ["", "1", "1.0", "-5", "{key}", "{a b}", "{=}", "true", "x := 1; y := 'a'", 'say "hi"', "“so”", "it's"]
    ),
    st.text(st.characters(codec="utf-8", exclude_categories=["Cs"]), max_size=8),
)
_SUBTREES = (
    "patrol", "big dance", "GraspObject", "Approach Shelf", "then", "wave", "it's {x}", "greet {who}",
    "visit {stop} {n}", "each_stop", "each_stop", "each_n_2",
)  # fmt: skip
_GIVEN = ("Alice", "lab", "3", "two words", "{goal}", "{count}", "{who}", "{_1}", "a}")
_keys = st.one_of(
    st.sampled_from(
        [
            "num_cycles",
            "msec",
            "_skipIf",
            "_uid",
            "value",
            "a",
            "say",
            "newline",
            "width",
            "goal_pose",
            "goal_pose",
            "X1",
        ]
    ),
    st.from_regex(r"[A-Za-z_][A-Za-z0-9_.-]{0,6}", fullmatch=True),
)
_ports = st.dictionaries(_keys, texts, max_size=2).map(lambda ports: tuple(ports.items()))
_names = st.one_of(st.just(""), st.just(""), st.just(""), texts)
_some_ports = st.one_of(st.just(()), st.just(()), _ports)


def leaves(subtrees: Sequence[str]) -> st.SearchStrategy[Node]:
    """Leaves of all kinds, and uses of subtrees."""
    known = st.sampled_from([*_PHRASES, *_PHRASES, *_CONDITIONS, *_CONDITIONS])
    plain = known.map(lambda leaf: Node(leaf[0], (), leaf[1]))
    own = st.builds(Node, st.sampled_from(_OWN_LEAVES), st.just(()), _ports, _names)
    valued = st.sampled_from(_VALUES).map(lambda leaf: Node(leaf[0], (), leaf[1]))
    detailed = st.builds(_detailed, st.sampled_from([*_PHRASES, *_CONDITIONS, *_VALUES]), _ports, _names)
    prepared = st.sampled_from(_COMPUTED).map(_computed)
    built_in = [node_id for node_id, (_, most) in SHAPES.items() if not most and node_id != SUBTREE]
    odd = st.builds(Node, st.sampled_from(built_in), st.just(()), _ports, _names)
    if not subtrees:
        return st.one_of(plain, plain, valued, valued, detailed, prepared, own, odd)
    uses = st.builds(
        lambda name, ports: Node("SubTree", (), (("ID", name), *(p for p in ports if p[0] != "ID"))),
        st.sampled_from(list(subtrees)),
        _some_ports,
    )
    given = st.dictionaries(st.sampled_from(["who", "stop", "n", "count"]), st.sampled_from(_GIVEN), max_size=2)
    filled = st.builds(_use, st.sampled_from(list(subtrees)), given)
    loop = st.lists(filled, min_size=2, max_size=3).map(lambda rounds: Node("Sequence", tuple(rounds)))
    return st.one_of(plain, plain, valued, valued, detailed, prepared, own, odd, uses, filled, filled, loop)


def _detailed(leaf: tuple[str, tuple[tuple[str, str], ...]], ports: tuple[tuple[str, str], ...], name: str) -> Node:
    """A leaf that words say, with a name and with ports that they don't say."""
    return Node(leaf[0], (), tuple((dict(ports) | dict(leaf[1])).items()), name)


def _computed(made: tuple[tuple[str, ...], str, str]) -> Node:
    codes, node_id, port = made
    key = codes[-1].split()[0]
    scripts = [Node("Script", (), (("code", code),)) for code in codes]
    return Node("Sequence", (*scripts, Node(node_id, (), ((port, f"{{{key}}}"),))))


def _use(name: str, ports: dict[str, str]) -> Node:
    """With all parameters, as a mission would, and other ports."""
    own = dict.fromkeys(re.findall(r"{(\w+)}", name), "Alice") | ports
    if name.startswith("each_"):
        own.setdefault(name[5:9].strip("_"), "lab")
    return Node("SubTree", (), (("ID", name), *own.items()))


def nodes(subtrees: Sequence[str] = (), most: int = 10) -> st.SearchStrategy[Node]:
    """Trees of about so many leaves."""

    def inner(below: st.SearchStrategy[Node]) -> st.SearchStrategy[Node]:
        def of(node_id: str) -> st.SearchStrategy[Node]:
            few, many = SHAPES[node_id]
            children = st.lists(below, min_size=few, max_size=many).map(tuple)
            return st.builds(Node, st.just(node_id), children, _some_ports, _names)

        plain = st.builds(
            lambda node_id, children: Node(node_id, tuple(children)),
            st.sampled_from(_NATURAL[:3]),
            st.lists(below, min_size=2, max_size=3),
        )
        numbered = st.builds(
            lambda what, child: Node(what[0], (child,), (what[1:],)),
            st.sampled_from(
                [
                    ("Repeat", "num_cycles", "3"),
                    ("Repeat", "num_cycles", "-1"),
                    ("Timeout", "msec", "2500"),
                    ("RetryUntilSuccessful", "num_attempts", "2"),
                    ("Delay", "delay_msec", "100"),
                ]
            ),
            below,
        )
        shaped = st.sampled_from([*_NATURAL, *_INNER]).flatmap(of)
        bare = st.sampled_from(_NATURAL).flatmap(
            lambda node_id: st.lists(below, min_size=SHAPES[node_id][0], max_size=SHAPES[node_id][1]).map(
                lambda children: Node(node_id, tuple(children))
            )
        )
        own = st.builds(
            Node,
            st.sampled_from(["MyDecorator", "do twice"]),
            st.lists(below, min_size=1, max_size=2).map(tuple),
            _some_ports,
            _names,
        )
        return st.one_of(plain, plain, numbered, bare, shaped, own)

    return st.recursive(leaves(subtrees), inner, max_leaves=most)


@st.composite
def trees(draw: st.DrawFn) -> Tree:
    """With named subtrees, each of which may use those before it."""
    names = draw(st.lists(st.sampled_from(_SUBTREES), max_size=3, unique=True))
    subtrees = tuple((name, draw(nodes(names[:at], 5))) for at, name in enumerate(names))
    name = draw(st.sampled_from(["", "", "Main Tree"]))
    return Tree(draw(nodes(names)), subtrees, name, MODELS)
