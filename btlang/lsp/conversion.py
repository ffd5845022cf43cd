"""Data about a document as the types of the protocol."""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator
from itertools import islice
from typing import Any

from lsprotocol import types
from pygls.uris import from_fs_path

from btlang.editing.changes import find_difference
from btlang.lsp.documents import MISSION, TEST, Document
from btlang.text.source import Source

NAME = "btlang"
RUN, TESTS, TREE = "btlang.run", "btlang.test", "btlang.tree"
"""The commands of code lenses, which clients run: the server runs nothing."""
_SEVERITIES = {
    "error": types.DiagnosticSeverity.Error,
    "warning": types.DiagnosticSeverity.Warning,
    "note": types.DiagnosticSeverity.Information,
}
_COLOURS = {
    "command": "function", "condition": "property", "name": "type", "word": "keyword", "text": "string",
    "number": "number", "comment": "comment",
}  # fmt: skip
LEGEND = types.SemanticTokensLegend(token_types=list(_COLOURS.values()), token_modifiers=[])
_SYMBOLS = {
    "definition": types.SymbolKind.Function,
    "fact": types.SymbolKind.Object,
    "rule": types.SymbolKind.Event,
    "command": types.SymbolKind.Method,
    "include": types.SymbolKind.Module,
}
_COMPLETIONS = {
    "command": types.CompletionItemKind.Function,
    "condition": types.CompletionItemKind.Property,
    "name": types.CompletionItemKind.Class,
    "value": types.CompletionItemKind.Value,
    "connective": types.CompletionItemKind.Keyword,
}
_MOST = 60  # completions; clients ask again at each key


def diagnostics(document: Document) -> list[types.Diagnostic]:
    """Return the messages that a document has now."""
    return [_diagnostic(message, document) for message in document.messages]


def _diagnostic(message: dict[str, Any], document: Document) -> types.Diagnostic:
    is_here = message["start"] is not None
    lines = [message["message"], *([message["hint"]] if message["hint"] else [])]
    if not is_here:
        lines.insert(0, f"{message['file']}:{message['line']}:{message['column']}:")
    related = [
        types.DiagnosticRelatedInformation(
            types.Location(document.uri, document.positions.range(note["start"], note["end"])), note["message"]
        )
        for note in message["notes"]
        if note["start"] is not None
    ]
    return types.Diagnostic(
        range=document.positions.range(message["start"] or 0, message["end"] or 0),
        message="\n".join(lines),
        severity=_SEVERITIES[message["severity"]],
        code=message["code"],
        source=NAME,
        related_information=related or None,
    )


def code_actions(document: Document, range: types.Range) -> list[types.CodeAction]:
    """Return the corrections of the messages in a range: those that a message offers, and one for each reading."""
    start, end = document.positions.offsets(range)
    found: list[types.CodeAction] = []
    for message in document.messages:
        if message["start"] is None or message["start"] > end or message["end"] < start:
            continue
        fixes = [message["fix"]] if message["fix"] is not None else []
        for change in (*fixes, *message["readings"]):
            if change["start"] is not None:
                action = types.CodeAction(
                    title=_title(change, document.text),
                    kind=types.CodeActionKind.QuickFix,
                    diagnostics=[_diagnostic(message, document)],
                    edit=workspace_edit(document, [change]),
                    is_preferred=change in fixes,
                )
                found.append(action)
    return found


def _title(change: dict[str, Any], text: str) -> str:
    old, new = text[change["start"] : change["end"]].strip(), change["text"].strip()
    if not new:
        return f"Remove '{old}'"
    return f"Replace '{old}' with '{new}'" if old else f"Insert '{new}'"


def workspace_edit(document: Document, changes: Iterable[dict[str, Any]]) -> types.WorkspaceEdit:
    """Return changes of a document, each with `start`, `end` and `text`."""
    edits = [
        types.TextEdit(document.positions.range(change["start"], change["end"]), change["text"]) for change in changes
    ]
    return types.WorkspaceEdit(changes={document.uri: edits})


def formatting(document: Document, text: str) -> list[types.TextEdit]:
    """Return what makes another text of a document, as the smallest change."""
    change = find_difference(document.text, text)
    if document.text == text:
        return []
    return [types.TextEdit(document.positions.range(change.start, change.end), change.text)]


def completion_list(document: Document, found: Iterable[dict[str, Any]], at: int) -> types.CompletionList:
    """Return completions as btlang.editing.help.complete lists them. Clients ask again at each key."""
    items = [
        types.CompletionItem(
            label=each["text"].strip(),
            kind=_COMPLETIONS.get(each["kind"]),
            detail=each["help"] or None,
            sort_text=f"{number:04}",
            filter_text=document.text[each["start"] : at] if each["spelling"] else each["text"],
            text_edit=types.TextEdit(document.positions.range(each["start"], at), each["text"]),
        )
        for number, each in enumerate(islice(found, _MOST))
    ]
    return types.CompletionList(is_incomplete=True, items=items)


def hover(document: Document, found: dict[str, Any]) -> types.Hover:
    """Return what was understood at a place: the words, the help, and the tree of the statement."""
    parts = [_fenced(found["words"]), found["help"]]
    if found["example"]:
        parts.append(f"Example: `{found['example']}`")
    if found["tree"]:
        parts.append(_fenced(found["tree"]))
    content = types.MarkupContent(types.MarkupKind.Markdown, "\n\n".join(part for part in parts if part))
    return types.Hover(content, document.positions.range(found["start"], found["end"]))


def _fenced(text: str) -> str:
    longest = max((len(run) for run in re.findall("`+", text)), default=0)
    fence = "`" * max(3, longest + 1)
    return f"{fence}text\n{text}\n{fence}"


def symbols(document: Document, outline: Iterable[dict[str, Any]]) -> list[types.DocumentSymbol]:
    """Return the outline of a document."""
    found = []
    for part in outline:
        first, last = min(part["of"][0], part["start"]), max(part["of"][1], part["end"])
        found.append(
            types.DocumentSymbol(
                name=part["name"].strip() or "…",
                kind=_SYMBOLS[part["kind"]],
                range=document.positions.range(first, last),
                selection_range=document.positions.range(part["start"], part["end"]),
            )
        )
    return found


def folding_ranges(document: Document, folds: Iterable[tuple[int, int]]) -> list[types.FoldingRange]:
    """Return the lines that fold; those of the data end with line feeds alone."""
    source, position = Source(document.text), document.positions.position
    return [
        types.FoldingRange(position(source.offset(first + 1)).line, position(source.offset(last + 1)).line)
        for first, last in folds
    ]


def inlay_hints(document: Document, brackets: Iterable[dict[str, Any]], range: types.Range) -> list[types.InlayHint]:
    """Return the brackets in a range as hints."""
    start, end = document.positions.offsets(range)
    return [
        types.InlayHint(document.positions.position(each["at"]), each["text"], tooltip="How the words are grouped.")
        for each in brackets
        if start <= each["at"] <= end
    ]


def semantic_tokens(document: Document, tokens: Iterable[dict[str, Any]]) -> types.SemanticTokens:
    """Return the colours of a text, of which each is in one line."""
    data: list[int] = []
    kinds = list(_COLOURS)
    line = column = 0
    for start, end, kind in _in_lines(document.text, tokens):
        first, last = document.positions.position(start), document.positions.position(end)
        same = first.line == line
        data += [first.line - line, first.character - column if same else first.character]
        data += [last.character - first.character, kinds.index(kind), 0]
        line, column = first.line, first.character
    return types.SemanticTokens(data)


def _in_lines(text: str, tokens: Iterable[dict[str, Any]]) -> Iterator[tuple[int, int, str]]:
    for token in tokens:
        for part in re.finditer(r"[^\r\n]+", text[token["start"] : token["end"]]):
            yield token["start"] + part.start(), token["start"] + part.end(), token["kind"]


def location(document: Document, target: dict[str, Any]) -> types.Location:
    """Return where a reference of a document leads."""
    if not target["file"]:
        return types.Location(document.uri, document.positions.range(*target["place"]))
    line, column, end_line, end_column = target["place"]
    range = types.Range(types.Position(line, column), types.Position(end_line, end_column))
    return types.Location(from_fs_path(target["file"]) or "", range)


def reference_at(references: Iterable[dict[str, Any]], at: int) -> dict[str, Any] | None:
    """Return the shortest reference at a character."""
    around = [each for each in references if each["start"] <= at <= each["end"]]
    return min(around, key=lambda each: each["end"] - each["start"], default=None)


def code_lenses(document: Document, tests: Iterable[dict[str, Any]]) -> list[types.CodeLens]:
    """Return what can be done with a document: run a mission, show its tree, and run tests of it, or one of them."""
    top = document.positions.range(0, 0)
    found: list[types.CodeLens] = []
    if document.kind == MISSION:
        found = [_lens(top, "Run", RUN, document.uri), _lens(top, "Show tree", TREE, document.uri)]
    if document.kind == TEST:
        found = [_lens(top, "Run all tests", TESTS, document.uri)]
    for test in tests:
        place = document.positions.range(test["start"], test["end"])
        if test["file"]:
            found.append(_lens(place, "Test", TESTS, from_fs_path(test["file"]) or ""))
        else:
            found.append(_lens(place, "Run test", TESTS, document.uri, test["name"]))
    return found


def _lens(range: types.Range, title: str, command: str, *arguments: str) -> types.CodeLens:
    return types.CodeLens(range, types.Command(title, command, arguments=list(arguments)))
