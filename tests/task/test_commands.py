"""Commands as JSON: what is read is what their schema describes."""

from __future__ import annotations

import json
from typing import Any

import jsonschema
import pytest
from hypothesis import given
from hypothesis import strategies as st

from btlang.diagnostics.diagnostic import MissionError
from btlang.task import messages
from btlang.task.commands.schema import schema
from btlang.task.messages import COMMANDS, as_json, read_command
from tests.profiles import searches

FIELDS = sorted({field for kind in COMMANDS.values() for field in kind.fields})
VALUES = st.one_of(
    st.none(), st.booleans(), st.integers(-5, 5), st.floats(allow_nan=False), st.text(max_size=5),
    st.lists(st.text(max_size=3) | st.integers(), max_size=2), st.dictionaries(st.text(max_size=3), st.integers()),
)  # fmt: skip


@st.composite
def commands(draw: st.DrawFn) -> dict[str, Any]:
    """Mostly a command, with fields of its own, of others, or too few."""
    name = draw(st.sampled_from(sorted(COMMANDS)) | st.text(max_size=3))
    own = COMMANDS[name].fields if name in COMMANDS else ()
    fields = draw(st.lists(st.sampled_from([*own, *own, *FIELDS, "command2"]), unique=True, max_size=4))
    return {"command": name, **{field: draw(VALUES) for field in fields}}


def test_the_schema_is_one() -> None:
    jsonschema.Draft202012Validator.check_schema(schema())


@searches(200, 10_000, deadline=None)
@given(data=commands())
def test_what_is_read_is_what_the_schema_describes(data: dict[str, Any]) -> None:
    valid = jsonschema.Draft202012Validator(schema()).is_valid(data)
    try:
        command = read_command(data)
    except MissionError as error:
        problems = error.diagnostics
    else:
        problems = []
        assert read_command(json.loads(json.dumps(as_json(command)))) == command
    assert [problem.code for problem in problems] == ([] if valid else ["BT198"])


@pytest.mark.parametrize("kind", COMMANDS.values())
def test_every_command_is_described(kind: type[messages.Command]) -> None:
    [described] = [each for each in schema()["oneOf"] if each["properties"]["command"]["const"] == kind.tag]
    assert described["description"]
    assert set(described["properties"]) == {"command", *kind.fields}
