# Made from the catalogue by `python -m tests.generate`.
from typing import TypedDict, Unpack

from btlang.behavior import Behavior, Child, Value
from btlang.behavior import leaf as leaf

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

__all__: list[str]

def builder_name(node_id: str) -> str: ...
def sequence(*children: Child, name: str = "", **scripts: Unpack[Scripts]) -> Behavior:
    """Make the node Sequence of BehaviorTree.CPP."""

def async_sequence(*children: Child, name: str = "", **scripts: Unpack[Scripts]) -> Behavior:
    """Make the node AsyncSequence of BehaviorTree.CPP."""

def sequence_with_memory(*children: Child, name: str = "", **scripts: Unpack[Scripts]) -> Behavior:
    """Make the node SequenceWithMemory of BehaviorTree.CPP."""

def reactive_sequence(*children: Child, name: str = "", **scripts: Unpack[Scripts]) -> Behavior:
    """Make the node ReactiveSequence of BehaviorTree.CPP."""

def pipeline_sequence(*children: Child, name: str = "", **scripts: Unpack[Scripts]) -> Behavior:
    """Make the node PipelineSequence of Nav2."""

def nonblocking_sequence(*children: Child, name: str = "", **scripts: Unpack[Scripts]) -> Behavior:
    """Make the node NonblockingSequence of Nav2."""

def persistent_sequence(
    *children: Child, current_child_idx: int | str, name: str = "", **scripts: Unpack[Scripts]
) -> Behavior:
    """Make the node PersistentSequence of Nav2."""

def fallback(*children: Child, name: str = "", **scripts: Unpack[Scripts]) -> Behavior:
    """Make the node Fallback of BehaviorTree.CPP."""

def async_fallback(*children: Child, name: str = "", **scripts: Unpack[Scripts]) -> Behavior:
    """Make the node AsyncFallback of BehaviorTree.CPP."""

def reactive_fallback(*children: Child, name: str = "", **scripts: Unpack[Scripts]) -> Behavior:
    """Make the node ReactiveFallback of BehaviorTree.CPP."""

def round_robin(
    *children: Child, wrap_around: bool | str | None = None, name: str = "", **scripts: Unpack[Scripts]
) -> Behavior:
    """Make the node RoundRobin of Nav2."""

def parallel(
    *children: Child,
    success_count: int | str | None = None,
    failure_count: int | str | None = None,
    name: str = "",
    **scripts: Unpack[Scripts],
) -> Behavior:
    """Make the node Parallel of BehaviorTree.CPP."""

def parallel_all(
    *children: Child, max_failures: int | str | None = None, name: str = "", **scripts: Unpack[Scripts]
) -> Behavior:
    """Make the node ParallelAll of BehaviorTree.CPP."""

def if_then_else(
    if_: Child, then: Child, else_: Child | None = None, *, name: str = "", **scripts: Unpack[Scripts]
) -> Behavior:
    """Make the node IfThenElse of BehaviorTree.CPP."""

def while_do_else(
    while_: Child, do: Child, else_: Child | None = None, *, name: str = "", **scripts: Unpack[Scripts]
) -> Behavior:
    """Make the node WhileDoElse of BehaviorTree.CPP."""

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

def try_catch(
    *children: Child, catch_on_halt: bool | str | None = None, name: str = "", **scripts: Unpack[Scripts]
) -> Behavior:
    """Make the node TryCatch of BehaviorTree.CPP."""

def recovery_node(
    *children: Child, number_of_retries: int | str | None = None, name: str = "", **scripts: Unpack[Scripts]
) -> Behavior:
    """Make the node RecoveryNode of Nav2."""

def pause_resume_controller(
    *children: Child,
    pause_service_name: Value | None = None,
    resume_service_name: Value | None = None,
    name: str = "",
    **scripts: Unpack[Scripts],
) -> Behavior:
    """Make the node PauseResumeController of Nav2."""

def switch_2(
    *children: Child, variable: Value, case_1: Value, case_2: Value, name: str = "", **scripts: Unpack[Scripts]
) -> Behavior:
    """Make the node Switch2 of BehaviorTree.CPP."""

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

def inverter(child: Child, *, name: str = "", **scripts: Unpack[Scripts]) -> Behavior:
    """Make the node Inverter of BehaviorTree.CPP."""

def force_success(child: Child, *, name: str = "", **scripts: Unpack[Scripts]) -> Behavior:
    """Make the node ForceSuccess of BehaviorTree.CPP."""

def force_failure(child: Child, *, name: str = "", **scripts: Unpack[Scripts]) -> Behavior:
    """Make the node ForceFailure of BehaviorTree.CPP."""

def repeat(child: Child, *, num_cycles: int | str, name: str = "", **scripts: Unpack[Scripts]) -> Behavior:
    """Make the node Repeat of BehaviorTree.CPP."""

def retry_until_successful(
    child: Child, *, num_attempts: int | str, name: str = "", **scripts: Unpack[Scripts]
) -> Behavior:
    """Make the node RetryUntilSuccessful of BehaviorTree.CPP."""

def keep_running_until_failure(child: Child, *, name: str = "", **scripts: Unpack[Scripts]) -> Behavior:
    """Make the node KeepRunningUntilFailure of BehaviorTree.CPP."""

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

def keep_out(child: Child, *, zones: Value, name: str = "", **scripts: Unpack[Scripts]) -> Behavior:
    """Make the node KeepOut of btlang. The robot keeps out of the zones (names between semicolons) while the child
    runs.
    """

def keep_in(child: Child, *, zones: Value, name: str = "", **scripts: Unpack[Scripts]) -> Behavior:
    """Make the node KeepIn of btlang. The robot stays in the zones (names between semicolons) while the child runs."""

def timeout(child: Child, *, msec: int | str, name: str = "", **scripts: Unpack[Scripts]) -> Behavior:
    """Make the node Timeout of BehaviorTree.CPP."""

def delay(child: Child, *, delay_msec: int | str, name: str = "", **scripts: Unpack[Scripts]) -> Behavior:
    """Make the node Delay of BehaviorTree.CPP."""

def rate_controller(
    child: Child, *, hz: float | str | None = None, name: str = "", **scripts: Unpack[Scripts]
) -> Behavior:
    """Make the node RateController of Nav2."""

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

def goal_updated_controller(
    child: Child, *, goal: Value | None = None, goals: Value | None = None, name: str = "", **scripts: Unpack[Scripts]
) -> Behavior:
    """Make the node GoalUpdatedController of Nav2."""

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

def path_longer_on_approach(
    child: Child,
    *,
    path: Value,
    prox_len: float | str | None = None,
    length_factor: float | str | None = None,
    name: str = "",
    **scripts: Unpack[Scripts],
) -> Behavior:
    """Make the node PathLongerOnApproach of Nav2."""

def single_trigger(child: Child, *, name: str = "", **scripts: Unpack[Scripts]) -> Behavior:
    """Make the node SingleTrigger of Nav2."""

def run_once(
    child: Child, *, then_skip: bool | str | None = None, name: str = "", **scripts: Unpack[Scripts]
) -> Behavior:
    """Make the node RunOnce of BehaviorTree.CPP."""

def precondition(
    child: Child, *, if_: Value, else_: Value | None = None, name: str = "", **scripts: Unpack[Scripts]
) -> Behavior:
    """Make the node Precondition of BehaviorTree.CPP."""

def skip_unless_updated(child: Child, *, entry: Value, name: str = "", **scripts: Unpack[Scripts]) -> Behavior:
    """Make the node SkipUnlessUpdated of BehaviorTree.CPP."""

def wait_value_update(child: Child, *, entry: Value, name: str = "", **scripts: Unpack[Scripts]) -> Behavior:
    """Make the node WaitValueUpdate of BehaviorTree.CPP."""

def was_entry_updated(*, entry: Value, name: str = "", **scripts: Unpack[Scripts]) -> Behavior:
    """Make the node WasEntryUpdated of BehaviorTree.CPP."""

def script_condition(*, code: Value, name: str = "", **scripts: Unpack[Scripts]) -> Behavior:
    """Make the node ScriptCondition of BehaviorTree.CPP."""

def script(*, code: Value, name: str = "", **scripts: Unpack[Scripts]) -> Behavior:
    """Make the node Script of BehaviorTree.CPP."""

def set_blackboard(*, value: Value, output_key: Value, name: str = "", **scripts: Unpack[Scripts]) -> Behavior:
    """Make the node SetBlackboard of BehaviorTree.CPP."""

def unset_blackboard(*, key: Value, name: str = "", **scripts: Unpack[Scripts]) -> Behavior:
    """Make the node UnsetBlackboard of BehaviorTree.CPP."""

def sleep(*, msec: int | str, name: str = "", **scripts: Unpack[Scripts]) -> Behavior:
    """Make the node Sleep of BehaviorTree.CPP."""

def wait_for_time(*, time: Value, name: str = "", **scripts: Unpack[Scripts]) -> Behavior:
    """Make the node WaitForTime of btlang. Ends when the clock next shows a time of day such as 18:30."""

def always_success(*, name: str = "", **scripts: Unpack[Scripts]) -> Behavior:
    """Make the node AlwaysSuccess of BehaviorTree.CPP."""

def always_failure(*, name: str = "", **scripts: Unpack[Scripts]) -> Behavior:
    """Make the node AlwaysFailure of BehaviorTree.CPP."""

def sub_tree(*, ID: Value, name: str = "", **scripts: Value) -> Behavior:
    """Make the node SubTree of BehaviorTree.CPP."""
