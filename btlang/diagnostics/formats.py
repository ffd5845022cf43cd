"""Diagnostics as documents for programs: JSON, SARIF 2.1.0 and workflow commands of GitHub Actions.

Code scanning and editors read SARIF; GitHub shows what its commands name beside the lines of a pull request. Our
JSON is an array with an object for each diagnostic, in the order of `sort_diagnostics`, on one line. Its keys are
those of `to_data`; docs/messages.md describes them for users. Keys may be added, none gets another meaning.
"""

from __future__ import annotations

import json
import os
from collections.abc import Iterable
from pathlib import Path
from urllib.parse import quote

from btlang.diagnostics.codes import CODES
from btlang.diagnostics.diagnostic import Diagnostic, sort_diagnostics
from btlang.diagnostics.explain import title_of
from btlang.text.source import Span

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any

_IN_DATA = str.maketrans({"%": "%25", "\r": "%0D", "\n": "%0A"})
_IN_PROPERTIES = str.maketrans({"%": "%25", "\r": "%0D", "\n": "%0A", ":": "%3A", ",": "%2C"})


def format_json(problems: Iterable[Diagnostic]) -> str:
    """Format the document, in ASCII without a line end."""
    return json.dumps([to_data(problem) for problem in sort_diagnostics(list(problems))])


def to_data(problem: Diagnostic) -> dict[str, Any]:
    """Convert one diagnostic to an object.

    - `code`, `severity` ("error", "warning" or "note"), `message`, `hint` (lines joined by line ends, "" for none);
    - `file`, `line`, `column`, `end_line`, `end_column`: where it is. Lines and columns count from 1, columns in
      characters (Unicode code points); the end is exclusive: the place just after the last character;
    - `words`: the text at that place;
    - `fix`: None, or `text` and the place whose characters it replaces;
    - `readings`: such changes, each of which leaves one of the readings that the text has;
    - `notes`: objects with a `message` and its place.
    """
    kind = problem.kind
    summary = {"code": problem.code, "severity": kind.severity, "message": problem.message, "hint": problem.hint}
    fix = None if problem.fix is None else _change(*problem.fix)
    readings = [_change(*reading) for reading in problem.readings]
    notes = [{"message": text, **_place(span)} for span, text in problem.notes]
    return {
        **summary,
        **_place(problem.span),
        "words": problem.span.text,
        "fix": fix,
        "readings": readings,
        "notes": notes,
    }


def _change(span: Span, text: str) -> dict[str, str | int]:
    return {"text": text, **_place(span)}


def _place(span: Span) -> dict[str, str | int]:
    line, column = span.source.position(span.start)
    end_line, end_column = span.source.position(span.end)
    return {
        "file": span.source.name,
        "line": line,
        "column": column,
        "end_line": end_line,
        "end_column": end_column,
    }


def format_sarif(problems: Iterable[Diagnostic]) -> str:
    """Format the document, in ASCII without a line end. Columns count characters, as in our own JSON."""
    ordered = sort_diagnostics(list(problems))
    codes = list(dict.fromkeys(problem.code for problem in ordered))
    rules = [
        {"id": code, "shortDescription": {"text": title_of(code)},
         "defaultConfiguration": {"level": CODES[code].severity}}
        for code in codes
    ]  # fmt: skip
    driver = {"name": "btlang", "rules": rules}
    results = [_result(problem, codes.index(problem.code)) for problem in ordered]
    run = {"tool": {"driver": driver}, "columnKind": "unicodeCodePoints", "results": results}
    return json.dumps({"version": "2.1.0", "runs": [run]})


def _result(problem: Diagnostic, rule: int) -> dict[str, Any]:
    message = "\n".join(line for line in (problem.message, problem.hint) if line)
    result: dict[str, Any] = {
        "ruleId": problem.code,
        "ruleIndex": rule,
        "level": problem.kind.severity,
        "message": {"text": message},
        "locations": [{"physicalLocation": _sarif_location(problem.span)}],
    }
    if problem.notes:
        result["relatedLocations"] = [
            {"id": number, "physicalLocation": _sarif_location(span), "message": {"text": text}}
            for number, (span, text) in enumerate(problem.notes, 1)
        ]
    if problem.fix is not None:
        span, text = problem.fix
        replaced = {"deletedRegion": _region(span), "insertedContent": {"text": text}}
        change = {"artifactLocation": {"uri": _uri(span.source.name)}, "replacements": [replaced]}
        result["fixes"] = [{"description": {"text": f"Write {text!r} here."}, "artifactChanges": [change]}]
    return result


def _sarif_location(span: Span) -> dict[str, Any]:
    return {"artifactLocation": {"uri": _uri(span.source.name)}, "region": _region(span)}


def _region(span: Span) -> dict[str, int]:
    line, column = span.source.position(span.start)
    end_line, end_column = span.source.position(span.end)
    return {"startLine": line, "startColumn": column, "endLine": end_line, "endColumn": end_column}


def _uri(name: str) -> str:
    # bytes that aren't UTF-8 are in a name as halves of characters, which as_uri writes as bytes again, too
    return Path(name).as_uri() if os.path.isabs(name) else quote(os.fsencode(name.replace(os.sep, "/")))


def format_github(problems: Iterable[Diagnostic]) -> str:
    """Format a line for each: `::error file=...,line=...,col=...,title=BT122::message`, "" for none."""
    return "\n".join(_command(problem) for problem in sort_diagnostics(list(problems)))


def _command(problem: Diagnostic) -> str:
    data = to_data(problem)
    properties = {"file": data["file"], "line": data["line"], "endLine": data["end_line"], "col": data["column"],
                  "endColumn": data["end_column"], "title": data["code"]}  # fmt: skip
    if data["line"] != data["end_line"]:  # GitHub takes columns of a single line only
        del properties["col"], properties["endColumn"]
    parameters = ",".join(f"{name}={str(value).translate(_IN_PROPERTIES)}" for name, value in properties.items())
    message = "\n".join(line for line in (problem.message, problem.hint) if line)
    command = "notice" if data["severity"] == "note" else data["severity"]
    return f"::{command} {parameters}::{message.translate(_IN_DATA)}"
