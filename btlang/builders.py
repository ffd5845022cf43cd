"""Functions that build trees: one for each built-in node. Made from the catalogue by `python -m tests.generate`.

The keyword arguments are the ports of the node; docs/engine.md says what each node does.
"""

from __future__ import annotations

from btlang.behavior import Behavior, Child, Value, built, leaf

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import TypedDict, Unpack

    class Scripts(TypedDict, total=False):
        """Scripts that every node may have."""

        _failureIf: str
        _successIf: str
        _onlyIf: str
        _skipIf: str
        _while: str
        _onSuccess: str
        _onFailure: str
        _onHalted: str
        _post: str


__all__ = [
    "always_failure",
    "always_success",
    "async_fallback",
    "async_sequence",
    "delay",
    "distance_controller",
    "fallback",
    "force_failure",
    "force_success",
    "goal_updated_controller",
    "goal_updater",
    "if_then_else",
    "inverter",
    "keep_in",
    "keep_out",
    "keep_running_until_failure",
    "leaf",
    "loop_bool",
    "loop_double",
    "loop_int",
    "loop_string",
    "nonblocking_sequence",
    "parallel",
    "parallel_all",
    "pause_resume_controller",
    "persistent_sequence",
    "pipeline_sequence",
    "precondition",
    "rate_controller",
    "reactive_fallback",
    "reactive_sequence",
    "recovery_node",
    "repeat",
    "retry_until_successful",
    "round_robin",
    "run_once",
    "script",
    "script_condition",
    "sequence",
    "sequence_with_memory",
    "set_blackboard",
    "single_trigger",
    "skip_unless_updated",
    "sleep",
    "speed_controller",
    "sub_tree",
    "switch_2",
    "switch_3",
    "switch_4",
    "switch_5",
    "switch_6",
    "timeout",
    "try_catch",
    "unset_blackboard",
    "wait_for_time",
    "wait_value_update",
    "was_entry_updated",
    "whenever",
    "while_do_else",
]


def sequence(*children: Child, name: str = "", **scripts: Unpack[Scripts]) -> Behavior:
    """Make the node Sequence of BehaviorTree.CPP."""
    return built("Sequence", children, {}, name, scripts)


def async_sequence(*children: Child, name: str = "", **scripts: Unpack[Scripts]) -> Behavior:
    """Make the node AsyncSequence of BehaviorTree.CPP."""
    return built("AsyncSequence", children, {}, name, scripts)


def sequence_with_memory(*children: Child, name: str = "", **scripts: Unpack[Scripts]) -> Behavior:
    """Make the node SequenceWithMemory of BehaviorTree.CPP."""
    return built("SequenceWithMemory", children, {}, name, scripts)


def reactive_sequence(*children: Child, name: str = "", **scripts: Unpack[Scripts]) -> Behavior:
    """Make the node ReactiveSequence of BehaviorTree.CPP."""
    return built("ReactiveSequence", children, {}, name, scripts)


def pipeline_sequence(*children: Child, name: str = "", **scripts: Unpack[Scripts]) -> Behavior:
    """Make the node PipelineSequence of Nav2."""
    return built("PipelineSequence", children, {}, name, scripts)


def nonblocking_sequence(*children: Child, name: str = "", **scripts: Unpack[Scripts]) -> Behavior:
    """Make the node NonblockingSequence of Nav2."""
    return built("NonblockingSequence", children, {}, name, scripts)


def persistent_sequence(
    *children: Child, current_child_idx: int | str, name: str = "", **scripts: Unpack[Scripts]
) -> Behavior:
    """Make the node PersistentSequence of Nav2."""
    return built("PersistentSequence", children, {"current_child_idx": current_child_idx}, name, scripts)


def fallback(*children: Child, name: str = "", **scripts: Unpack[Scripts]) -> Behavior:
    """Make the node Fallback of BehaviorTree.CPP."""
    return built("Fallback", children, {}, name, scripts)


def async_fallback(*children: Child, name: str = "", **scripts: Unpack[Scripts]) -> Behavior:
    """Make the node AsyncFallback of BehaviorTree.CPP."""
    return built("AsyncFallback", children, {}, name, scripts)


def reactive_fallback(*children: Child, name: str = "", **scripts: Unpack[Scripts]) -> Behavior:
    """Make the node ReactiveFallback of BehaviorTree.CPP."""
    return built("ReactiveFallback", children, {}, name, scripts)


def round_robin(
    *children: Child, wrap_around: bool | str | None = None, name: str = "", **scripts: Unpack[Scripts]
) -> Behavior:
    """Make the node RoundRobin of Nav2."""
    return built("RoundRobin", children, {"wrap_around": wrap_around}, name, scripts)


def parallel(
    *children: Child,
    success_count: int | str | None = None,
    failure_count: int | str | None = None,
    name: str = "",
    **scripts: Unpack[Scripts],
) -> Behavior:
    """Make the node Parallel of BehaviorTree.CPP."""
    return built("Parallel", children, {"success_count": success_count, "failure_count": failure_count}, name, scripts)


def parallel_all(
    *children: Child, max_failures: int | str | None = None, name: str = "", **scripts: Unpack[Scripts]
) -> Behavior:
    """Make the node ParallelAll of BehaviorTree.CPP."""
    return built("ParallelAll", children, {"max_failures": max_failures}, name, scripts)


def if_then_else(
    if_: Child, then: Child, else_: Child | None = None, *, name: str = "", **scripts: Unpack[Scripts]
) -> Behavior:
    """Make the node IfThenElse of BehaviorTree.CPP."""
    return built("IfThenElse", (if_, then, else_), {}, name, scripts)


def while_do_else(
    while_: Child, do: Child, else_: Child | None = None, *, name: str = "", **scripts: Unpack[Scripts]
) -> Behavior:
    """Make the node WhileDoElse of BehaviorTree.CPP."""
    return built("WhileDoElse", (while_, do, else_), {}, name, scripts)


def whenever(
    whenever: Child,
    reaction: Child,
    work: Child,
    *,
    once: bool | str | None = None,
    name: str = "",
    **scripts: Unpack[Scripts],
) -> Behavior:
    """Make the node Whenever of btlang. Condition, reaction, work. Each time the condition becomes true (with
    once=true only the first time), the work is suspended, the reaction runs once, and the work goes on.
    """
    return built("Whenever", (whenever, reaction, work), {"once": once}, name, scripts)


def try_catch(
    *children: Child, catch_on_halt: bool | str | None = None, name: str = "", **scripts: Unpack[Scripts]
) -> Behavior:
    """Make the node TryCatch of BehaviorTree.CPP."""
    return built("TryCatch", children, {"catch_on_halt": catch_on_halt}, name, scripts)


def recovery_node(
    *children: Child, number_of_retries: int | str | None = None, name: str = "", **scripts: Unpack[Scripts]
) -> Behavior:
    """Make the node RecoveryNode of Nav2."""
    return built("RecoveryNode", children, {"number_of_retries": number_of_retries}, name, scripts)


def pause_resume_controller(
    *children: Child,
    pause_service_name: Value | None = None,
    resume_service_name: Value | None = None,
    name: str = "",
    **scripts: Unpack[Scripts],
) -> Behavior:
    """Make the node PauseResumeController of Nav2."""
    return built(
        "PauseResumeController",
        children,
        {"pause_service_name": pause_service_name, "resume_service_name": resume_service_name},
        name,
        scripts,
    )


def switch_2(
    *children: Child, variable: Value, case_1: Value, case_2: Value, name: str = "", **scripts: Unpack[Scripts]
) -> Behavior:
    """Make the node Switch2 of BehaviorTree.CPP."""
    return built("Switch2", children, {"variable": variable, "case_1": case_1, "case_2": case_2}, name, scripts)


def switch_3(
    *children: Child,
    variable: Value,
    case_1: Value,
    case_2: Value,
    case_3: Value,
    name: str = "",
    **scripts: Unpack[Scripts],
) -> Behavior:
    """Make the node Switch3 of BehaviorTree.CPP."""
    return built(
        "Switch3", children, {"variable": variable, "case_1": case_1, "case_2": case_2, "case_3": case_3}, name, scripts
    )


def switch_4(
    *children: Child,
    variable: Value,
    case_1: Value,
    case_2: Value,
    case_3: Value,
    case_4: Value,
    name: str = "",
    **scripts: Unpack[Scripts],
) -> Behavior:
    """Make the node Switch4 of BehaviorTree.CPP."""
    return built(
        "Switch4",
        children,
        {"variable": variable, "case_1": case_1, "case_2": case_2, "case_3": case_3, "case_4": case_4},
        name,
        scripts,
    )


def switch_5(
    *children: Child,
    variable: Value,
    case_1: Value,
    case_2: Value,
    case_3: Value,
    case_4: Value,
    case_5: Value,
    name: str = "",
    **scripts: Unpack[Scripts],
) -> Behavior:
    """Make the node Switch5 of BehaviorTree.CPP."""
    return built(
        "Switch5",
        children,
        {
            "variable": variable,
            "case_1": case_1,
            "case_2": case_2,
            "case_3": case_3,
            "case_4": case_4,
            "case_5": case_5,
        },
        name,
        scripts,
    )


def switch_6(
    *children: Child,
    variable: Value,
    case_1: Value,
    case_2: Value,
    case_3: Value,
    case_4: Value,
    case_5: Value,
    case_6: Value,
    name: str = "",
    **scripts: Unpack[Scripts],
) -> Behavior:
    """Make the node Switch6 of BehaviorTree.CPP."""
    return built(
        "Switch6",
        children,
        {
            "variable": variable,
            "case_1": case_1,
            "case_2": case_2,
            "case_3": case_3,
            "case_4": case_4,
            "case_5": case_5,
            "case_6": case_6,
        },
        name,
        scripts,
    )


def inverter(child: Child, *, name: str = "", **scripts: Unpack[Scripts]) -> Behavior:
    """Make the node Inverter of BehaviorTree.CPP."""
    return built("Inverter", (child,), {}, name, scripts)


def force_success(child: Child, *, name: str = "", **scripts: Unpack[Scripts]) -> Behavior:
    """Make the node ForceSuccess of BehaviorTree.CPP."""
    return built("ForceSuccess", (child,), {}, name, scripts)


def force_failure(child: Child, *, name: str = "", **scripts: Unpack[Scripts]) -> Behavior:
    """Make the node ForceFailure of BehaviorTree.CPP."""
    return built("ForceFailure", (child,), {}, name, scripts)


def repeat(child: Child, *, num_cycles: int | str, name: str = "", **scripts: Unpack[Scripts]) -> Behavior:
    """Make the node Repeat of BehaviorTree.CPP."""
    return built("Repeat", (child,), {"num_cycles": num_cycles}, name, scripts)


def retry_until_successful(
    child: Child, *, num_attempts: int | str, name: str = "", **scripts: Unpack[Scripts]
) -> Behavior:
    """Make the node RetryUntilSuccessful of BehaviorTree.CPP."""
    return built("RetryUntilSuccessful", (child,), {"num_attempts": num_attempts}, name, scripts)


def keep_running_until_failure(child: Child, *, name: str = "", **scripts: Unpack[Scripts]) -> Behavior:
    """Make the node KeepRunningUntilFailure of BehaviorTree.CPP."""
    return built("KeepRunningUntilFailure", (child,), {}, name, scripts)


def loop_int(
    child: Child,
    *,
    queue: Value,
    if_empty: Value | None = None,
    value: Value | None = None,
    name: str = "",
    **scripts: Unpack[Scripts],
) -> Behavior:
    """Make the node LoopInt of BehaviorTree.CPP."""
    return built("LoopInt", (child,), {"queue": queue, "if_empty": if_empty, "value": value}, name, scripts)


def loop_bool(
    child: Child,
    *,
    queue: Value,
    if_empty: Value | None = None,
    value: Value | None = None,
    name: str = "",
    **scripts: Unpack[Scripts],
) -> Behavior:
    """Make the node LoopBool of BehaviorTree.CPP."""
    return built("LoopBool", (child,), {"queue": queue, "if_empty": if_empty, "value": value}, name, scripts)


def loop_double(
    child: Child,
    *,
    queue: Value,
    if_empty: Value | None = None,
    value: Value | None = None,
    name: str = "",
    **scripts: Unpack[Scripts],
) -> Behavior:
    """Make the node LoopDouble of BehaviorTree.CPP."""
    return built("LoopDouble", (child,), {"queue": queue, "if_empty": if_empty, "value": value}, name, scripts)


def loop_string(
    child: Child,
    *,
    queue: Value,
    if_empty: Value | None = None,
    value: Value | None = None,
    name: str = "",
    **scripts: Unpack[Scripts],
) -> Behavior:
    """Make the node LoopString of BehaviorTree.CPP."""
    return built("LoopString", (child,), {"queue": queue, "if_empty": if_empty, "value": value}, name, scripts)


def keep_out(child: Child, *, zones: Value, name: str = "", **scripts: Unpack[Scripts]) -> Behavior:
    """Make the node KeepOut of btlang. The robot keeps out of the zones (names between semicolons) while the child
    runs.
    """
    return built("KeepOut", (child,), {"zones": zones}, name, scripts)


def keep_in(child: Child, *, zones: Value, name: str = "", **scripts: Unpack[Scripts]) -> Behavior:
    """Make the node KeepIn of btlang. The robot stays in the zones (names between semicolons) while the child runs."""
    return built("KeepIn", (child,), {"zones": zones}, name, scripts)


def timeout(child: Child, *, msec: int | str, name: str = "", **scripts: Unpack[Scripts]) -> Behavior:
    """Make the node Timeout of BehaviorTree.CPP."""
    return built("Timeout", (child,), {"msec": msec}, name, scripts)


def delay(child: Child, *, delay_msec: int | str, name: str = "", **scripts: Unpack[Scripts]) -> Behavior:
    """Make the node Delay of BehaviorTree.CPP."""
    return built("Delay", (child,), {"delay_msec": delay_msec}, name, scripts)


def rate_controller(
    child: Child, *, hz: float | str | None = None, name: str = "", **scripts: Unpack[Scripts]
) -> Behavior:
    """Make the node RateController of Nav2."""
    return built("RateController", (child,), {"hz": hz}, name, scripts)


def speed_controller(
    child: Child,
    *,
    min_rate: float | str | None = None,
    max_rate: float | str | None = None,
    min_speed: float | str | None = None,
    max_speed: float | str | None = None,
    goal: Value | None = None,
    goals: Value | None = None,
    name: str = "",
    **scripts: Unpack[Scripts],
) -> Behavior:
    """Make the node SpeedController of Nav2."""
    return built(
        "SpeedController",
        (child,),
        {
            "min_rate": min_rate,
            "max_rate": max_rate,
            "min_speed": min_speed,
            "max_speed": max_speed,
            "goal": goal,
            "goals": goals,
        },
        name,
        scripts,
    )


def distance_controller(
    child: Child,
    *,
    distance: float | str | None = None,
    global_frame: Value | None = None,
    robot_base_frame: Value | None = None,
    name: str = "",
    **scripts: Unpack[Scripts],
) -> Behavior:
    """Make the node DistanceController of Nav2."""
    return built(
        "DistanceController",
        (child,),
        {"distance": distance, "global_frame": global_frame, "robot_base_frame": robot_base_frame},
        name,
        scripts,
    )


def goal_updated_controller(
    child: Child, *, goal: Value | None = None, goals: Value | None = None, name: str = "", **scripts: Unpack[Scripts]
) -> Behavior:
    """Make the node GoalUpdatedController of Nav2."""
    return built("GoalUpdatedController", (child,), {"goal": goal, "goals": goals}, name, scripts)


def goal_updater(
    child: Child,
    *,
    input_goal: Value | None = None,
    input_goals: Value | None = None,
    output_goal: Value | None = None,
    output_goals: Value | None = None,
    name: str = "",
    **scripts: Unpack[Scripts],
) -> Behavior:
    """Make the node GoalUpdater of Nav2."""
    return built(
        "GoalUpdater",
        (child,),
        {
            "input_goal": input_goal,
            "input_goals": input_goals,
            "output_goal": output_goal,
            "output_goals": output_goals,
        },
        name,
        scripts,
    )


def single_trigger(child: Child, *, name: str = "", **scripts: Unpack[Scripts]) -> Behavior:
    """Make the node SingleTrigger of Nav2."""
    return built("SingleTrigger", (child,), {}, name, scripts)


def run_once(
    child: Child, *, then_skip: bool | str | None = None, name: str = "", **scripts: Unpack[Scripts]
) -> Behavior:
    """Make the node RunOnce of BehaviorTree.CPP."""
    return built("RunOnce", (child,), {"then_skip": then_skip}, name, scripts)


def precondition(
    child: Child, *, if_: Value, else_: Value | None = None, name: str = "", **scripts: Unpack[Scripts]
) -> Behavior:
    """Make the node Precondition of BehaviorTree.CPP."""
    return built("Precondition", (child,), {"if": if_, "else": else_}, name, scripts)


def skip_unless_updated(child: Child, *, entry: Value, name: str = "", **scripts: Unpack[Scripts]) -> Behavior:
    """Make the node SkipUnlessUpdated of BehaviorTree.CPP."""
    return built("SkipUnlessUpdated", (child,), {"entry": entry}, name, scripts)


def wait_value_update(child: Child, *, entry: Value, name: str = "", **scripts: Unpack[Scripts]) -> Behavior:
    """Make the node WaitValueUpdate of BehaviorTree.CPP."""
    return built("WaitValueUpdate", (child,), {"entry": entry}, name, scripts)


def was_entry_updated(*, entry: Value, name: str = "", **scripts: Unpack[Scripts]) -> Behavior:
    """Make the node WasEntryUpdated of BehaviorTree.CPP."""
    return built("WasEntryUpdated", (), {"entry": entry}, name, scripts)


def script_condition(*, code: Value, name: str = "", **scripts: Unpack[Scripts]) -> Behavior:
    """Make the node ScriptCondition of BehaviorTree.CPP."""
    return built("ScriptCondition", (), {"code": code}, name, scripts)


def script(*, code: Value, name: str = "", **scripts: Unpack[Scripts]) -> Behavior:
    """Make the node Script of BehaviorTree.CPP."""
    return built("Script", (), {"code": code}, name, scripts)


def set_blackboard(*, value: Value, output_key: Value, name: str = "", **scripts: Unpack[Scripts]) -> Behavior:
    """Make the node SetBlackboard of BehaviorTree.CPP."""
    return built("SetBlackboard", (), {"value": value, "output_key": output_key}, name, scripts)


def unset_blackboard(*, key: Value, name: str = "", **scripts: Unpack[Scripts]) -> Behavior:
    """Make the node UnsetBlackboard of BehaviorTree.CPP."""
    return built("UnsetBlackboard", (), {"key": key}, name, scripts)


def sleep(*, msec: int | str, name: str = "", **scripts: Unpack[Scripts]) -> Behavior:
    """Make the node Sleep of BehaviorTree.CPP."""
    return built("Sleep", (), {"msec": msec}, name, scripts)


def wait_for_time(*, time: Value, name: str = "", **scripts: Unpack[Scripts]) -> Behavior:
    """Make the node WaitForTime of btlang. Ends when the clock next shows a time of day such as 18:30."""
    return built("WaitForTime", (), {"time": time}, name, scripts)


def always_success(*, name: str = "", **scripts: Unpack[Scripts]) -> Behavior:
    """Make the node AlwaysSuccess of BehaviorTree.CPP."""
    return built("AlwaysSuccess", (), {}, name, scripts)


def always_failure(*, name: str = "", **scripts: Unpack[Scripts]) -> Behavior:
    """Make the node AlwaysFailure of BehaviorTree.CPP."""
    return built("AlwaysFailure", (), {}, name, scripts)


def sub_tree(*, ID: Value, name: str = "", **scripts: Value) -> Behavior:
    """Make the node SubTree of BehaviorTree.CPP."""
    return built("SubTree", (), {"ID": ID}, name, scripts)
