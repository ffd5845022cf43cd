"""Leaves with a fixed status: always_success_node.h and always_failure_node.h of BehaviorTree.CPP 4.10."""

from __future__ import annotations

from collections.abc import Sequence
from functools import partial

from btlang.engine.instance import NodeInstance, halt_nothing
from btlang.engine.status import SKIPPED, SUCCESS

TYPE_CHECKING = False
if TYPE_CHECKING:
    from btlang.engine.instance import Compiled


def always_success(instance: NodeInstance, children: Sequence[Compiled]) -> Compiled:
    """SUCCESS."""
    return (lambda: SUCCESS), halt_nothing


def always_failure(instance: NodeInstance, children: Sequence[Compiled]) -> Compiled:
    """FAILURE."""
    return partial(instance.fail, "the mission says so"), halt_nothing


def skipped(instance: NodeInstance, children: Sequence[Compiled]) -> Compiled:
    """What a node with _skipIf="true" is: SKIPPED, and nothing below it is ticked."""
    return (lambda: SKIPPED), halt_nothing
