"""Random trees of all node types, with awkward names and texts, for what is written as XML and read again."""

from __future__ import annotations

from hypothesis import strategies as st

from btlang.tree.catalogue import CATALOGUE, SUBTREE
from btlang.tree.node import Node, Tree

AWKWARD = (
    "", " ", "{x}", "{=}", "{", "}", "{}", "a<b", "a>b", "a & b", "&amp;", "&#65;", '"', "'", "\n", "\t", "\r", "\r\n",
    " a ", "]]>", "<!--", "-->", "--", "é", "ドア", "🚪", "x y", "\ue000", "x := 1; y = 'two'", "a && b", "0.5", "1",
    "true", "\x85", "\u2028", "{a b}", "{{x}}", "$x",
)  # fmt: skip
TEXTS = st.one_of(
    st.sampled_from(AWKWARD),
    st.text(st.characters(exclude_categories=("Cs", "Cc")), max_size=8),
).filter(lambda text: "${" not in text and not {"\ufffe", "\uffff"} & set(text))
"""Without `${x}`, which in version 3 means `{x}`."""
NAMES = st.sampled_from(("a", "b2", "goal_pose", "Über", "x-y", "値", "request.name", "variable", "ID2", "_uid"))
CONDITIONS = st.sampled_from(("_failureIf", "_successIf", "_skipIf", "_while", "_onSuccess", "_onHalted", "_post"))
LEAF_IDS = st.sampled_from((
    "GoTo", "Wave", "Say", "Öffne", "Move Base", "request.done", "is-ready", "Action", "Root", "1st", "Battery", "Spin",
    "MainTree", "PlanMTCTask", "UIShow",
))  # fmt: skip
INNER_IDS = st.sampled_from(("Shuffle", "Odd Decorator", "SpeedController", "SingleTrigger"))
TREE_NAMES = (
    "patrol", "greet {someone}", "go & see", "MainTree", "Sequence", "Wave", "a.b", "ドア", "Root", "A b", "A_b",
    'say "x"',
)  # fmt: skip
PORTS = st.dictionaries(st.one_of(NAMES, CONDITIONS), TEXTS, max_size=3)


def _node(node_id: str, children: list[Node], ports: dict[str, str], name: str) -> Node:
    return Node(node_id, tuple(children), tuple(ports.items()), name)


LEAVES = st.builds(
    _node,
    st.one_of(LEAF_IDS, st.sampled_from([id for id, kind in CATALOGUE.items() if kind.most == 0 and id != SUBTREE])),
    st.just([]),
    PORTS,
    TEXTS,
)
SHARES = st.dictionaries(st.sampled_from(("success_count", "failure_count")), TEXTS)


def _parents(children: st.SearchStrategy[Node]) -> st.SearchStrategy[Node]:
    ids = st.one_of(INNER_IDS, st.sampled_from([id for id, kind in CATALOGUE.items() if kind.most > 0]))
    several = st.lists(children, min_size=1, max_size=4)
    return st.one_of(
        st.builds(_node, ids, several, PORTS, TEXTS), st.builds(_node, st.just("Parallel"), several, SHARES, TEXTS)
    )


NODES = st.recursive(LEAVES, _parents, max_leaves=10)


def _use(name: str, ports: dict[str, str], autoremap: str, called: str) -> Node:
    remapped = {"_autoremap": autoremap} if autoremap else {}
    return Node("SubTree", (), (("ID", name), *{**ports, **remapped}.items()), called)


@st.composite
def trees(draw: st.DrawFn) -> Tree:
    """A tree with up to four subtrees, each of which may use those before it."""
    names = draw(st.lists(st.sampled_from(TREE_NAMES), unique=True, max_size=4))
    main = draw(st.sampled_from(("", *TREE_NAMES)))
    names = [name for name in names if name not in (main, "MainTree" if main == "" else main)]
    subtrees: list[tuple[str, Node]] = []
    for name in names:
        subtrees.append((name, draw(_body(tuple(name for name, _ in subtrees)))))
    root = draw(_body(tuple(names)))
    order = draw(st.permutations(subtrees))
    return Tree(root, tuple(order), "" if main == "MainTree" else main)


def _body(names: tuple[str, ...]) -> st.SearchStrategy[Node]:
    if not names:
        return NODES
    uses = st.builds(_use, st.sampled_from(names), PORTS, st.sampled_from(("", "true", "false", "{x}")), TEXTS)
    return st.builds(lambda node, used: Node("Sequence", (node, *used)), NODES, st.lists(uses, max_size=3))
