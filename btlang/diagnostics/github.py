"""Diagnostics as workflow commands of GitHub Actions, which show them beside the lines of a pull request."""

from __future__ import annotations

from collections.abc import Iterable

from btlang.diagnostics.data import as_data
from btlang.diagnostics.diagnostic import Diagnostic
from btlang.diagnostics.errors import in_order

_IN_DATA = str.maketrans({"%": "%25", "\r": "%0D", "\n": "%0A"})
_IN_PROPERTIES = str.maketrans({"%": "%25", "\r": "%0D", "\n": "%0A", ":": "%3A", ",": "%2C"})


def as_github(problems: Iterable[Diagnostic]) -> str:
    """A line for each: `::error file=...,line=...,col=...,title=BT122::message`, "" for none."""
    return "\n".join(_command(problem) for problem in in_order(list(problems)))


def _command(problem: Diagnostic) -> str:
    data = as_data(problem)
    properties = {"file": data["file"], "line": data["line"], "endLine": data["end_line"], "col": data["column"],
                  "endColumn": data["end_column"], "title": data["code"]}  # fmt: skip
    if data["line"] != data["end_line"]:  # GitHub takes columns of a single line only
        del properties["col"], properties["endColumn"]
    parameters = ",".join(f"{name}={str(value).translate(_IN_PROPERTIES)}" for name, value in properties.items())
    message = "\n".join(line for line in (problem.message, problem.hint) if line)
    command = "notice" if data["severity"] == "note" else data["severity"]
    return f"::{command} {parameters}::{message.translate(_IN_DATA)}"
