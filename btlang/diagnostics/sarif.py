"""Diagnostics as SARIF 2.1.0, which code scanning and editors read."""

from __future__ import annotations

import json
import os
from collections.abc import Iterable
from pathlib import Path
from urllib.parse import quote

from btlang.diagnostics.codes import CODES
from btlang.diagnostics.diagnostic import Diagnostic
from btlang.diagnostics.errors import in_order
from btlang.diagnostics.explain import title_of
from btlang.text.source import Span

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any


def as_sarif(problems: Iterable[Diagnostic]) -> str:
    """The document, in ASCII without a line end. Columns count characters, as in our own JSON."""
    ordered = in_order(list(problems))
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
        "locations": [{"physicalLocation": _location(problem.span)}],
    }
    if problem.notes:
        result["relatedLocations"] = [
            {"id": number, "physicalLocation": _location(span), "message": {"text": text}}
            for number, (span, text) in enumerate(problem.notes, 1)
        ]
    if problem.fix is not None:
        span, text = problem.fix
        replaced = {"deletedRegion": _region(span), "insertedContent": {"text": text}}
        change = {"artifactLocation": {"uri": _uri(span.source.name)}, "replacements": [replaced]}
        result["fixes"] = [{"description": {"text": f"Write {text!r} here."}, "artifactChanges": [change]}]
    return result


def _location(span: Span) -> dict[str, Any]:
    return {"artifactLocation": {"uri": _uri(span.source.name)}, "region": _region(span)}


def _region(span: Span) -> dict[str, int]:
    line, column = span.source.position(span.start)
    end_line, end_column = span.source.position(span.end)
    return {"startLine": line, "startColumn": column, "endLine": end_line, "endColumn": end_column}


def _uri(name: str) -> str:
    # bytes that aren't UTF-8 are in a name as halves of characters, which as_uri writes as bytes again, too
    return Path(name).as_uri() if os.path.isabs(name) else quote(os.fsencode(name.replace(os.sep, "/")))
