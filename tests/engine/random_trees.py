"""Random trees of all node types, with leaves that return what a random script says."""

from __future__ import annotations

from hypothesis import strategies as st

from btlang.tree.node import Node, Tree

from .scripted import World, n


def letters(weighted: str, least: int, most: int) -> st.SearchStrategy[str]:
    """Texts of these letters, each as likely as it is frequent there; `st.text` takes the letters for a set."""
    return st.lists(st.sampled_from(weighted), min_size=least, max_size=most).map("".join)


IN_ORDER = ("Sequence", "Fallback", "AsyncSequence", "AsyncFallback", "SequenceWithMemory")
REACTIVE = ("ReactiveSequence", "ReactiveFallback")
PLAIN_DECORATORS = ("Inverter", "ForceSuccess", "ForceFailure", "KeepRunningUntilFailure")
ASKED = st.sampled_from(("x > 1", "x < 3", "true", "false", "y == '1'", "_p == 1", "@x > 1", "gone"))
DONE = st.sampled_from(("x := 1", "x += 1", "z := x", "_p := 1", "@x := 2", "gone"))
PATHS = tuple(
    n("SetBlackboard", output_key="p", value=f"json:[[{start}, 0], [0, 0], [{goal}, 0]]")
    for start, goal in ((-1, 0), (-4, 0), (-9, 0), (-4, 1))
)
SUBTREES = st.fixed_dictionaries(
    {"_autoremap": st.sampled_from(("true", "false"))},
    optional={
        "x": st.sampled_from(("{x}", "{y}", "{z}")),
        "y": st.sampled_from(("{x}", "{_p}", "1")),
        "z": st.sampled_from(("{x}", "{q}", "2")),
    },
)
CONDITIONS = st.one_of(
    st.tuples(st.sampled_from(("_failureIf", "_successIf", "_onlyIf", "_skipIf", "_while")), ASKED),
    st.tuples(st.sampled_from(("_onSuccess", "_onFailure", "_onHalted", "_post")), DONE),
)


def _parents(children: st.SearchStrategy[Node]) -> st.SearchStrategy[Node]:
    def many(id: str, **ports: object) -> st.SearchStrategy[Node]:
        return st.lists(children, min_size=1, max_size=4).map(lambda c: n(id, *c, **ports))

    def parallel(c: list[Node]) -> st.SearchStrategy[Node]:
        share = st.integers(-len(c), len(c))
        return st.tuples(share, share).map(lambda s: n("Parallel", *c, success_count=s[0], failure_count=s[1]))

    branches = st.lists(children, min_size=2, max_size=3)
    return st.one_of(
        st.sampled_from(IN_ORDER + REACTIVE).flatmap(many),
        st.sampled_from(REACTIVE).flatmap(many),
        st.lists(children, min_size=1, max_size=4).flatmap(parallel),
        many("Parallel", success_count=-1, failure_count=1),
        many("ParallelAll", max_failures=1),
        branches.map(lambda c: n("IfThenElse", *c)),
        branches.map(lambda c: n("WhileDoElse", *c)),
        st.tuples(st.sampled_from(PLAIN_DECORATORS), children).map(lambda d: n(d[0], d[1])),
        st.tuples(st.sampled_from((-1, 0, 1, 2, 3)), children).map(lambda d: n("Repeat", d[1], num_cycles=d[0])),
        st.tuples(st.sampled_from((-1, 0, 1, 2, 3)), children).map(
            lambda d: n("RetryUntilSuccessful", d[1], num_attempts=d[0])
        ),
        st.tuples(st.sampled_from((1000, 2000, 3000)), children).map(lambda d: n("Timeout", d[1], msec=d[0])),
        st.tuples(st.sampled_from((0, 1000, 2000)), children).map(lambda d: n("Delay", d[1], delay_msec=d[0])),
        st.tuples(children, st.lists(CONDITIONS, min_size=1, max_size=3)).map(_conditioned),
        *_more_parents(children),
    )


def _conditioned(drawn: tuple[Node, list[tuple[str, str]]]) -> Node:
    node, conditions = drawn
    return Node(node.id, node.children, tuple({**dict(node.ports), **dict(conditions)}.items()))


def _more_parents(children: st.SearchStrategy[Node]) -> list[st.SearchStrategy[Node]]:
    def several(id: str, least: int, most: int, **ports: object) -> st.SearchStrategy[Node]:
        return st.lists(children, min_size=least, max_size=most).map(lambda c: n(id, *c, **ports))

    def around(id: str, **ports: st.SearchStrategy[object]) -> st.SearchStrategy[Node]:
        return st.tuples(children, st.fixed_dictionaries(ports)).map(lambda d: n(id, d[0], **d[1]))

    return [
        several("Switch2", 3, 3, variable="{x}", case_1=1, case_2=2),
        several("Switch3", 4, 4, variable="{x}", case_1=2, case_2=1, case_3=3),
        several("TryCatch", 2, 4, catch_on_halt="true"),
        st.sampled_from(("true", "false", "{x}")).flatmap(lambda on: several("TryCatch", 2, 4, catch_on_halt=on)),
        several("Whenever", 3, 3),
        several("Whenever", 3, 3),
        several("PipelineSequence", 1, 4),
        several("NonblockingSequence", 1, 4),
        several("PipelineSequence", 1, 4).flatmap(
            lambda many: st.just(n(many.id, n("SingleTrigger", many.children[0]), *many.children[1:]))
        ),
        around("SingleTrigger"),
        several("PauseResumeController", 1, 4),
        several("PersistentSequence", 1, 4, current_child_idx="{x}"),
        around("GoalUpdater", input_goal=st.just("{x}"), output_goal=st.just("{y}")),
        st.tuples(children, st.permutations(PATHS)).map(  # with another path at each tick
            lambda d: n(
                "NonblockingSequence", n("PathLongerOnApproach", d[0], path="{p}"), n("AsyncSequence", *d[1], *d[1])
            )
        ),
        around("GoalUpdatedController", goal=st.just("{x}")),
        several("PipelineSequence", 1, 4).flatmap(
            lambda many: st.just(
                n(many.id, n("GoalUpdatedController", many.children[0], goal="{x}"), *many.children[1:])
            )
        ),
        several("PipelineSequence", 1, 4),
        st.sampled_from(("true", "false")).flatmap(lambda wraps: several("RoundRobin", 1, 4, wrap_around=wraps)),
        st.integers(0, 2).flatmap(lambda retries: several("RecoveryNode", 2, 2, number_of_retries=retries)),
        around("RateController", hz=st.sampled_from((0.4, 0.5, 2))),
        around("RunOnce", then_skip=st.sampled_from(("true", "false"))),
        around("Precondition", **{"if": ASKED, "else": st.sampled_from(("SUCCESS", "FAILURE", "SKIPPED", "RUNNING"))}),
        around(
            "LoopString",
            queue=st.sampled_from(("1;2", "1", "{q}")),
            value=st.just("{y}"),
            if_empty=st.sampled_from(("SUCCESS", "FAILURE", "SKIPPED")),
        ),
        around("SkipUnlessUpdated", entry=st.just("{x}")),
        around("WaitValueUpdate", entry=st.just("x")),
        st.tuples(children, SUBTREES, SUBTREES, st.booleans()).map(_used),
    ]


def _used(drawn: tuple[Node, dict[str, str], dict[str, str], bool]) -> Node:
    """A tree as a subtree, used once or twice; `_numbered` moves the child to where it belongs."""
    body, first, second, twice = drawn
    uses = [n("SubTree", body, **ports) for ports in (first, second)]
    return n("Sequence", *uses) if twice else uses[0]


LEAVES = st.one_of(
    st.tuples(st.sampled_from("FCG"), letters("rrssffkx", 1, 4)).map(lambda leaf: Node(":".join(leaf))),
    st.sampled_from((0, 1000, 2000)).map(lambda msec: n("Sleep", msec=msec)),
    st.sampled_from(("08:59", "09:00", "09:01", "09:02")).map(lambda time: n("WaitForTime", time=time)),
    ASKED.map(lambda code: n("ScriptCondition", code=code)),
    DONE.map(lambda code: n("Script", code=code)),
    st.sampled_from((("x", 1), ("x", 2), ("q", "1;2"))).map(lambda s: n("SetBlackboard", output_key=s[0], value=s[1])),
    st.sampled_from((n("UnsetBlackboard", key="x"), n("WasEntryUpdated", entry="{x}"), *PATHS)),
)
TREES = st.recursive(LEAVES, _parents, max_leaves=12)


def _busy_parents(children: st.SearchStrategy[Node]) -> st.SearchStrategy[Node]:
    many = ("ReactiveSequence", "ReactiveFallback", "Sequence", "Fallback", "PipelineSequence")
    chooses = ("Whenever", "WhileDoElse", "IfThenElse")
    return st.one_of(
        st.tuples(st.sampled_from(many), st.lists(children, min_size=2, max_size=3)).map(lambda d: n(d[0], *d[1])),
        st.tuples(st.sampled_from(chooses), st.lists(children, min_size=3, max_size=3)).map(lambda d: n(d[0], *d[1])),
        st.tuples(st.sampled_from((-1, 2)), children).map(lambda d: n("Repeat", d[1], num_cycles=d[0])),
        st.tuples(st.sampled_from((-1, 2)), children).map(lambda d: n("RetryUntilSuccessful", d[1], num_attempts=d[0])),
        children.map(lambda child: n("Timeout", child, msec=2000)),
        st.lists(children, min_size=2, max_size=3).map(lambda c: n("ParallelAll", *c, max_failures=1)),
        st.lists(children, min_size=2, max_size=4).map(lambda c: n("Parallel", *c, success_count=-1, failure_count=1)),
        st.lists(children, min_size=2, max_size=3).map(lambda c: n("TryCatch", *c, catch_on_halt="true")),
        st.tuples(st.sampled_from(("Inverter", "ForceSuccess", "KeepRunningUntilFailure")), children).map(
            lambda d: n(d[0], d[1])
        ),
    )


BUSY = st.recursive(
    st.tuples(st.sampled_from("CCG"), letters("rrrssfk", 1, 4)).map(lambda leaf: Node(":".join(leaf))),
    _busy_parents,
    max_leaves=8,
)
"""Trees in which nearly every node is an action or chooses among some."""


class Drawn:
    """A drawn tree, with an id of its own for each leaf, `F0`, `C1` or `G2`: a function, class or generator."""

    def __init__(self, shape: Node) -> None:
        self.scripts: dict[str, str] = {}
        self._subtrees: dict[int, tuple[str, Node]] = {}  # by the body that is used
        root = self._numbered(shape)
        self.tree = Tree(root, tuple(self._subtrees.values()))

    def _numbered(self, node: Node) -> Node:
        if ":" in node.id:
            kind, script = node.id.split(":")
            name = f"{kind}{len(self.scripts)}"
            self.scripts[name] = script
            return Node(name, ports=node.ports)
        if node.id == "SubTree":
            [body] = node.children
            if id(body) not in self._subtrees:
                numbered = self._numbered(body)
                self._subtrees[id(body)] = (f"t{len(self._subtrees)}", numbered)
            return Node("SubTree", ports=(("ID", self._subtrees[id(body)][0]), *node.ports))
        return Node(node.id, tuple(self._numbered(child) for child in node.children), node.ports)

    def bind(self, world: World) -> None:
        """Binds each leaf to its script."""
        for id, script in self.scripts.items():
            {"F": world.fn, "C": world.cls, "G": world.gen}[id[0]](id, script)
