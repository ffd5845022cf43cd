"""What an editor waits for at each key, from `btc lsp`: `python -m tests.benchmarks.language_server [--lines 2000]`.

Sentences are typed in the middle of a long mission, through standard input and output. Printed are the median, the 95th
percentile and the longest time in milliseconds from a key to its completions and to the messages about it, which are
provisional; what the process of the server computes for a key; and seconds from the last key to the messages about all
of the text and to all that is shown beside it.
"""

from __future__ import annotations

import argparse
import asyncio
import os
from collections.abc import Sequence
from pathlib import Path
from statistics import median
from time import perf_counter

from lsprotocol import types

from tests.benchmarks.missions import mission
from tests.lsp.client import Client, client

SENTENCES = (
    "go to the kitchen then wave at Bob", "if the battery is low, dock, otherwise go to the lab",
    "wave at Bobby then nodd", "pick up the cup, then go to the office and say hello",
)  # fmt: skip
BETWEEN_KEYS = 0.12  # seconds, as somebody types who is quick


async def typed(editor: Client, uri: str, line: int, version: int, words: str) -> tuple[list[float], list[float]]:
    """Seconds to the completions and to the messages, key by key."""
    document = types.TextDocumentIdentifier(uri)
    completions, messages = [], []
    for column, character in enumerate(words):
        began = perf_counter()
        editor.change(uri, version + column, ((line, column, line, column), character))
        asked = types.CompletionParams(document, types.Position(line, column + 1))
        await editor.ask(editor.text_document_completion_async, asked)
        completions.append(perf_counter() - began)
        await editor.messages(uri, version + column)
        messages.append(perf_counter() - began)
        await asyncio.sleep(max(0.0, BETWEEN_KEYS - messages[-1]))
    return completions, messages


async def measure(lines: int) -> None:
    """Types, and prints."""
    text = mission(lines)
    written = text.split("\n")
    free = (n for n in range(lines // 2, lines) if written[n][:1].isalpha() and written[n + 1][:1].isalpha())
    line = next(free)
    async with client(is_checked=False) as editor:
        uri = editor.open("file:///nowhere/long.txt", text)
        await editor.settled(uri)
        end = len(written[line])
        editor.change(uri, 2, ((line, end, line, end), "\n"))
        await editor.settled(uri)
        completions, messages, wholes, besides, computed = [], [], [], [], 0.0
        version = 3
        for words in SENTENCES:
            before = cpu_seconds(editor)
            found = await typed(editor, uri, line + 1, version, words)
            computed += cpu_seconds(editor) - before
            completions += found[0]
            messages += found[1]
            version += len(words)
            began = perf_counter()
            await editor.messages(uri, version - 1, 2)
            wholes.append(perf_counter() - began)
            await editor.settled(uri)
            besides.append(perf_counter() - began)
            editor.change(uri, version, ((line + 1, 0, line + 1, len(words)), ""))
            version += 1
            await editor.settled(uri)
    print(f"{lines:,} lines, load {os.getloadavg()[0]:.1f} on {os.cpu_count()} cores")
    show("key to completions", completions)
    show("key to messages", messages)
    print(f"computed in the server for a key: {computed / len(messages) * 1e3:.1f} ms")
    print(f"rest to all messages: {median(wholes):.1f} s; to all beside the text: {median(besides):.1f} s")


def cpu_seconds(editor: Client) -> float:
    """The seconds that the process of the server has computed, without that which reads whole texts; 0 but on Linux."""
    try:
        fields = Path(f"/proc/{editor.process_id}/stat").read_text(encoding="ascii").rpartition(")")[2].split()
    except OSError:
        return 0.0
    return (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")


def show(name: str, seconds: Sequence[float]) -> None:
    """Prints a line."""
    ordered = sorted(each * 1e3 for each in seconds)
    p95 = ordered[int(len(ordered) * 0.95)]
    print(
        f"{name}: median {median(ordered):.1f} ms, 95% {p95:.1f} ms, longest {ordered[-1]:.1f} ms, {len(ordered)} keys"
    )


def main() -> None:
    """Measures and prints."""
    options = argparse.ArgumentParser(description="How fast the language server answers.")
    options.add_argument("--lines", type=int, default=2_000)
    asyncio.run(measure(options.parse_args().lines))


if __name__ == "__main__":
    main()
