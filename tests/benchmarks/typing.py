"""Times from a key to the redrawn screen of the REPL: `python -m tests.benchmarks.typing`.

The last words of a line are typed key by key, through prompt_toolkit's real input and output. Printed are medians and
95th percentiles in milliseconds: until the tree is redrawn, and until the menu of what may follow is there.
"""

from __future__ import annotations

import asyncio
import io
import statistics
import tempfile
import time
from pathlib import Path

from prompt_toolkit.data_structures import Size
from prompt_toolkit.input import create_pipe_input
from prompt_toolkit.output.vt100 import Vt100_Output

from btlang.repl.draft import MissionDraft
from btlang.repl.screen import ReplScreen
from btlang.repl.store import DraftStore

SENTENCE = "go to the lab then wave at Alice and say hello, then (dock and look around) if the battery is low, then "
TYPED = "move forward 2 m and raise your left arm then nod"


def line_of(words: int) -> str:
    """So many words, and at the end those that will be typed."""
    return SENTENCE * round((words - len(TYPED.split())) / len(SENTENCE.split()))


async def measure(words: int, keys: str, folder: Path) -> tuple[list[float], list[float]]:
    """Milliseconds from each key to the screen with its tree, and to the screen with its menu."""
    draft = MissionDraft()
    drawn: list[float] = []
    menus: list[float] = []
    with create_pipe_input() as keyboard:
        output = Vt100_Output(io.StringIO(), get_size=lambda: Size(rows=40, columns=120), term="xterm")
        screen = ReplScreen(draft, DraftStore(folder), keyboard, output)
        rendered = asyncio.Event()
        screen.application.after_render += lambda _: rendered.set()
        screen.buffer.text = line_of(words)
        screen.buffer.cursor_position = len(screen.buffer.text)
        assert screen.preview().unfinished, "the line must be sound"
        running = asyncio.create_task(screen.application.run_async())
        await rendered.wait()
        for key in keys:
            await asyncio.sleep(0.05)  # what the last key began is over
            rendered.clear()
            before = screen.buffer.text
            began = time.perf_counter()
            keyboard.send_text(key)
            while screen.buffer.text == before:
                await rendered.wait()
                rendered.clear()
            drawn.append((time.perf_counter() - began) * 1e3)
            if screen.buffer.complete_while_typing():
                while screen.buffer.complete_state is None and time.perf_counter() - began < 0.3:
                    await asyncio.sleep(0.001)
                menus.append((time.perf_counter() - began) * 1e3)
        screen.application.exit(result="")
        await running
    return drawn, menus


def main() -> None:
    for words in (30, 200):
        with tempfile.TemporaryDirectory() as folder:
            drawn, menus = asyncio.run(measure(words, TYPED, Path(folder)))
        shown = [time for time in menus if time < 300]
        for name, times in (("tree", drawn), ("menu", shown)):
            middle, late = statistics.median(times), statistics.quantiles(times, n=20)[-1]
            print(
                f"key to {name}, line of {words} words: median {middle:.1f} ms, 95% {late:.1f} ms ({len(times)} keys)"
            )


if __name__ == "__main__":
    main()
