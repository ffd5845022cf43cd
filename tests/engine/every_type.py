"""A small tree around each node type that has children, in which something runs."""

from __future__ import annotations

from btlang.engine.engine import Engine
from btlang.engine.status import RUNNING
from btlang.tree.node import Node, Tree

from .scripted import World, leaves, n

SWITCHES = {f"Switch{cases}": ("R" + " s" * cases, {"variable": "1", "case_1": "1"}) for cases in range(2, 7)}
RUNS: dict[str, tuple[str, dict[str, str]]] = {
    "Sequence": ("s R", {}),
    "Fallback": ("f R", {}),
    "AsyncSequence": ("k R", {}),
    "AsyncFallback": ("k R", {}),
    "SequenceWithMemory": ("k R", {}),
    "Parallel": ("R s R", {}),
    "ParallelAll": ("R f R", {}),
    "ReactiveSequence": ("s R", {}),
    "ReactiveFallback": ("f R", {}),
    "IfThenElse": ("f s R", {}),
    "WhileDoElse": ("f s R", {}),
    **SWITCHES,
    "TryCatch": ("s R s", {}),
    "Whenever": ("R s R", {}),
    "PipelineSequence": ("s R", {}),
    "NonblockingSequence": ("R s R", {}),
    "SingleTrigger": ("R", {}),
    "PersistentSequence": ("s R", {"current_child_idx": "{at}"}),
    "SpeedController": ("R", {}),
    "DistanceController": ("R", {}),
    "GoalUpdatedController": ("R", {}),
    "GoalUpdater": ("R", {"input_goal": "{x}", "output_goal": "{y}"}),
    "PathLongerOnApproach": ("R", {"path": "{path}"}),
    "PauseResumeController": ("R s s s", {}),
    "RecoveryNode": ("f R", {}),
    "RoundRobin": ("f R", {}),
    "Inverter": ("R", {}),
    "ForceSuccess": ("R", {}),
    "ForceFailure": ("R", {}),
    "Repeat": ("R", {"num_cycles": "2"}),
    "RetryUntilSuccessful": ("R", {"num_attempts": "2"}),
    "Timeout": ("R", {"msec": "1000"}),
    "Delay": ("R", {"delay_msec": "0"}),
    "RateController": ("R", {}),
    "KeepRunningUntilFailure": ("R", {}),
    "RunOnce": ("R", {}),
    "Precondition": ("R", {"if": "true"}),
    "KeepOut": ("R", {"zones": "lab"}),
    "KeepIn": ("R", {"zones": "lab"}),
    **{f"Loop{kind}": ("R", {"queue": "1"}) for kind in ("Int", "Bool", "Double", "String")},
    "SkipUnlessUpdated": ("R", {"entry": "x"}),
    "WaitValueUpdate": ("R", {"entry": "x"}),
    "SubTree": ("R", {"ID": "go"}),
}
"""For each node type that has children: leaves, of which those in capitals run after one tick, and ports."""


def around(id: str, *children: Node) -> Tree:
    """A node of that type over these children, beside a leaf Z that runs."""
    ports = RUNS[id][1]
    if id == "SubTree":
        return Tree(n("ParallelAll", n(id, **ports), n("Z")), (("go", n("Sequence", *children)),))
    node = n(id, *children, **ports)
    if id == "PathLongerOnApproach":  # runs its child only once the path has become longer
        short, long = (n("SetBlackboard", output_key="path", value=f"json:[[{x}, 0], [0, 0]]") for x in (1, 9))
        node = n(
            "Sequence", short, n("RecoveryNode", n("Sequence", node, long, n("AlwaysFailure")), n("AlwaysSuccess"))
        )
    return Tree(n("ParallelAll", node, n("Z")))


def running(id: str) -> tuple[World, Engine, list[str]]:
    """The tree above after one tick, and the leaves in it that run."""
    world = World()
    world.cls("Z", "r")
    scripts = RUNS[id][0].split()
    engine = world.engine(around(id, *leaves(world, scripts)), watched=True)
    engine.blackboard.set("x", 1)
    engine.blackboard.set("at", 0)
    assert engine.tick() == RUNNING
    world.since()
    return world, engine, [name for name, script in zip("ABCDEFG", scripts, strict=False) if script == "R"] + ["Z"]
