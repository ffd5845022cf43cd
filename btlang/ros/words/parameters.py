"""A parameter of another node as a leaf: to set it, to test it, or as a quantity."""

from __future__ import annotations

from collections.abc import Callable, Generator, Mapping

from rcl_interfaces.srv import GetParameters, SetParameters
from rclpy.parameter import Parameter, parameter_value_to_python

from btlang.engine.leaves.leaf import Failed
from btlang.ros.graph import is_ready
from btlang.ros.subscriptions import AGE, Latest
from btlang.ros.words.clients import RosClients
from btlang.ros.words.servers import LIMIT, WAIT, await_answer, await_server, do_nothing
from btlang.ros.words.topics import make_comparison, make_measurement
from btlang.ros.words.word import RosWord
from btlang.vocabulary.ros_table import SLOT

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any

_PERIOD = 0.5  # seconds between two questions for the value of a parameter


def parameter_leaf(word: RosWord, clients: RosClients) -> Callable[..., Any]:
    """Return a generator leaf that sets a parameter, or a function that compares it or returns its number."""
    return _make_setter(word, clients) if word.entry.sort == "action" else _make_quantity(word, clients)


def _make_setter(word: RosWord, clients: RosClients) -> Callable[..., Any]:
    node, parameter = word.ros.name, word.ros.interface
    name = f"{node}/set_parameters"
    client = clients.service(SetParameters, name)
    value = _value(word)
    wait, limit = word.ros.get("wait", WAIT), word.ros.get("limit", LIMIT)

    def set_parameter(wake: Callable[[], object] = do_nothing, **values: Any) -> Generator[None, None, bool | Failed]:
        request = SetParameters.Request(parameters=[Parameter(parameter, value=value(values)).to_parameter_msg()])
        yield from await_server(clients, client, SetParameters, name, wait)
        answer = yield from await_answer(clients, client, name, request, limit, wake)
        [result] = answer.results
        return bool(result.successful) or Failed(result.reason or f"{node} refused the value of {parameter}")

    return set_parameter


def _value(word: RosWord) -> Callable[[Mapping[str, Any]], Any]:
    """Return the value to set: a slot in SI, whole if its type is, or the value itself."""
    given = word.ros.get("set")
    slot = SLOT.fullmatch(given) if isinstance(given, str) else None
    if slot is None:
        return lambda values: given
    name, whole = slot[1], word.types[slot[1]].whole
    try:
        factor = word.factor(name, slot[2] or "")
    except LookupError as error:
        raise word.misfit(word.ros.interface, given, str(error)) from None

    def value(values: Mapping[str, Any]) -> Any:
        said = values[name]
        return said if whole or isinstance(said, str) else float(said) * factor

    return value


def _make_quantity(word: RosWord, clients: RosClients) -> Callable[..., Any]:
    node, parameter = word.ros.name, word.ros.interface
    shown = f"{parameter} of {node}"
    latest = clients.parameter(node, parameter, lambda: _poll(clients, node, parameter, shown))
    age = word.ros.get("age", AGE)

    def value() -> Any:
        return latest.take(age)

    return (
        make_measurement(word, value, shown) if word.measured is not None else make_comparison(word, None, value, shown)
    )


def _poll(clients: RosClients, node: str, parameter: str, shown: str) -> Latest:
    """Return the value of a parameter, which is polled for as long as the node runs: a condition needs it at once."""
    name = f"{node}/get_parameters"
    client = clients.node.create_client(GetParameters, name)
    absent = False

    def absence() -> str:
        if not is_ready(client):
            return f"there is no node {node}"
        return f"the node {node} has no parameter {parameter}" if absent else ""

    latest = Latest(shown, clients.clock.now, absence)

    def got(future: Any) -> None:
        nonlocal absent
        answer = future.result()
        values = answer.values if answer is not None else ()
        value = parameter_value_to_python(values[0]) if values else None
        absent = value is None
        if not absent:
            latest.store(value)

    def ask() -> None:
        if is_ready(client):
            client.call_async(GetParameters.Request(names=[parameter])).add_done_callback(got)

    clients.node.create_timer(_PERIOD, ask, clock=clients.steady)
    return latest
