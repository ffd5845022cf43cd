"""Finds the class of a component: by an entry point of the group `btlang.components`, or as `module:Class`."""

from __future__ import annotations

import json
import os
import sys
from importlib.util import find_spec
from inspect import signature

from btlang.components.component import Component, ComponentError, ParameterError
from btlang.engine.leaves.leaf import describe_exception
from btlang.robots.files import module_of
from btlang.text.output import pass_on, show

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any

ENTRY_POINTS = "btlang.components"
WRONG_PARAMETERS = 3


def locate_class(place: str) -> str:
    """Return the `module:Class` of a name among the entry points; a `module:Class` stays. Raises ComponentError."""
    if ":" in place:
        return place
    from importlib.metadata import entry_points

    for entry_point in entry_points(group=ENTRY_POINTS, name=place):
        return entry_point.value.replace(" ", "")
    raise ComponentError(f'no package has a component "{place}"; or write its place, such as "coffee:Machine"')


def words_file(place: str, folder: str) -> str | None:
    """Return the keyword file of a component, `coffee.toml` next to `coffee.py`; None without one. Imports no
    component.
    """
    module = locate_class(place).partition(":")[0]
    if folder and "." not in module:
        path = os.path.join(folder, f"{module}.toml")
        if os.path.exists(os.path.join(folder, f"{module}.py")):
            return path if os.path.exists(path) else None
    try:
        spec = find_spec(module)
    except (ImportError, ValueError):
        return None
    if spec is None or spec.origin is None:
        return None
    path = f"{os.path.splitext(spec.origin)[0]}.toml"
    return path if os.path.exists(path) else None


def load_class(place: str, folder: str) -> type[Component]:
    """Return the class, from the folder of its robot file or from installed packages. Raises ComponentError."""
    module, _, name = locate_class(place).partition(":")
    try:
        found: Any = module_of(module, folder)
        for part in name.split("."):
            found = getattr(found, part)
    except Exception as problem:  # whatever somebody's module raises
        raise ComponentError(f"{place} can't be loaded: {describe_exception(problem)}") from problem
    if not (isinstance(found, type) and issubclass(found, Component)):
        raise ComponentError(f"{place} isn't a class that is derived from btlang.Component")
    return found


def describe(component: Component) -> dict[str, Any]:
    """Return the description of a component's class as JSON: version, needs, rate, parameters and methods."""
    kind = type(component)
    parameters = [parameter.described() for parameter in kind.parameters().values()]
    methods = {name: _takes(getattr(component, name)) for name in dir(kind) if _is_method(kind, name)}
    return {
        "version": str(kind.version), "needs": list(kind.needs), "rate": kind.rate, "parameters": parameters,
        "methods": methods,
    }  # fmt: skip


def _is_method(kind: type[Component], name: str) -> bool:
    return name[0] != "_" and not hasattr(Component, name) and callable(getattr(kind, name, None))


def _takes(method: Any) -> dict[str, Any]:
    """Return the names of a method's parameters, those without a default, and whether it takes any others."""
    try:
        parameters = signature(method).parameters.values()
    except (TypeError, ValueError):  # of a method that isn't written in Python
        return {"takes": [], "required": [], "takes_all": True}
    named = [each for each in parameters if each.kind in (each.POSITIONAL_OR_KEYWORD, each.KEYWORD_ONLY)]
    return {
        "takes": [each.name for each in named],
        "required": [each.name for each in named if each.default is each.empty],
        "takes_all": any(each.kind is each.VAR_KEYWORD for each in parameters),
    }


def main(place: str, folder: str, parameters: str) -> int:
    """Print the description of a class, for `btc robot check`, which runs this in another process, since it loads the
    class.

    Returns WRONG_PARAMETERS if only these are wrong.
    """
    try:
        component = load_class(place, folder)()
        component.set_parameters(json.loads(parameters))
        pass_on(json.dumps(describe(component)) + "\n")
    except ComponentError as problem:
        show(str(problem), sys.stderr)
        return WRONG_PARAMETERS if isinstance(problem, ParameterError) else 1
    return 0


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]))
