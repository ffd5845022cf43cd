"""Files of data from other programs: JSON, or YAML without what lets a small file grow."""

from __future__ import annotations

from btlang.diagnostics.diagnostic import diagnostic
from btlang.diagnostics.errors import MissionError
from btlang.robots.files import DataFileError
from btlang.text.json_text import NestedTooDeep, load_json
from btlang.text.source import NOWHERE, Source

TYPE_CHECKING = False
if TYPE_CHECKING:
    from types import ModuleType
    from typing import Any

_MOST_YAML = 1_000_000  # characters; reading so many takes seconds


class ForeignFileError(DataFileError):
    """A file of another program that no world can be made from."""

    code = "BT075"


def read_data(source: Source) -> Any:
    """What a text in JSON or YAML holds; of several documents in one a list of them.

    Raises ForeignFileError for what isn't such a text, MissionError (BT087) where PyYAML isn't installed.
    """
    try:
        return load_json(source.text)
    except NestedTooDeep:
        raise ForeignFileError("it is nested too deep", source.name, None, source) from None
    except ValueError:  # no JSON, or a number that is too long
        if source.name.lower().endswith(".json"):
            raise ForeignFileError("this isn't JSON", source.name, None, source) from None
    if len(source.text) > _MOST_YAML:
        message = f"a YAML file may have at most {_MOST_YAML:,} characters; write JSON instead"
        raise ForeignFileError(message, source.name, None, source)
    return _read_yaml(source)


def _read_yaml(source: Source) -> Any:
    yaml = yaml_module()

    class Loader(yaml.SafeLoader):  # type: ignore[misc, name-defined]
        def compose_node(self, parent: Any, index: Any) -> Any:
            if self.check_event(yaml.AliasEvent):
                place = self.peek_event().start_mark
                raise yaml.MarkedYAMLError(problem="aliases (*name) can't be used here", problem_mark=place)
            return super().compose_node(parent, index)

    try:
        documents = [each for each in yaml.load_all(source.text, Loader) if each is not None]
    except yaml.MarkedYAMLError as error:
        line = error.problem_mark.line + 1 if error.problem_mark is not None else None
        raise ForeignFileError(f"this isn't YAML: {error.problem}", source.name, line, source) from None
    except RecursionError:
        raise ForeignFileError("it is nested too deep", source.name, None, source) from None
    except (yaml.YAMLError, ValueError, OverflowError) as error:  # a character that may not be there, a wrong date
        raise ForeignFileError(f"this isn't YAML: {str(error).splitlines()[0]}", source.name, None, source) from None
    return documents[0] if len(documents) == 1 else documents


def yaml_module() -> ModuleType:
    """PyYAML. Raises MissionError (BT087) where it isn't installed."""
    try:
        import yaml
    except ImportError:
        raise missing("YAML files", "PyYAML") from None
    module: ModuleType = yaml
    return module


def missing(what: str, package: str) -> MissionError:
    """What to raise where a package of the extra `maps` isn't there."""
    return MissionError([diagnostic("BT087", NOWHERE, what=what, package=package)])
