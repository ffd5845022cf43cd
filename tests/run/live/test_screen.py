"""What is written to the terminal for a frame; tests/terminal shows what a terminal makes of it."""

from __future__ import annotations

import io
import os
import re

from btlang.run.live.screen import LiveScreen

Line = tuple[tuple[str, str], ...]


class Output(io.StringIO):
    """Gives what was written since it was last asked, without what only holds it together."""

    encoding = "utf-8"

    def taken(self) -> str:
        text = self.getvalue()
        self.seek(0)
        self.truncate()
        return re.sub(r"\x1b\[(\?2026[hl]|[0-9;]*m)", "", text)


def made(columns: int = 20, rows: int = 10) -> tuple[LiveScreen, Output, list[int]]:
    output, size = Output(), [columns, rows]
    return LiveScreen(output, lambda: os.terminal_size((size[0], size[1]))), output, size


def frame(*lines: str) -> list[Line]:
    return [((line, ""),) for line in lines]


def test_a_first_frame_and_one_like_it() -> None:
    screen, output, _ = made()
    screen.draw([], frame("one", "two"))
    assert output.taken() == "\rone\x1b[K\r\ntwo\x1b[K\x1b[J"
    screen.draw([], frame("one", "two"))
    assert output.taken() == ""


def test_only_lines_that_changed_are_written() -> None:
    screen, output, _ = made()
    screen.draw([], frame("one", "two", "three"))
    output.taken()
    screen.draw([], frame("one", "2", "three"))
    assert output.taken() == "\r\x1b[2A\r\n2\x1b[K\r\n"
    screen.draw([], frame("one"))
    assert output.taken() == "\r\x1b[2A\x1b[J"


def test_lines_above_push_the_frame_down() -> None:
    screen, output, _ = made()
    screen.draw([], frame("one", "two"))
    output.taken()
    screen.draw(["a\tb", "c\nd"], frame("one", "two"))
    a, c, d, one, two = output.taken().removeprefix("\r\x1b[1A").removesuffix("\x1b[J").split("\r\n")
    assert [a, c, d] == ["\x1b[Ka       b\x1b[K", "\x1b[Kc\x1b[K", "\x1b[Kd\x1b[K"]
    assert [one, two] == ["one\x1b[K", "two\x1b[K"]


def test_lines_are_cropped_and_too_many_are_left_out() -> None:
    screen, output, _ = made(columns=6, rows=3)
    screen.draw([], frame("longer", "日本語", "third"))
    assert output.taken() == "\rlong…\x1b[K\r\n日本…\x1b[K\x1b[J"


def test_a_narrower_terminal_has_wrapped_the_lines() -> None:
    screen, output, size = made(columns=20)
    screen.draw([], frame("0123456789", "abc"))
    output.taken()
    size[0] = 5
    screen.draw([], frame("0123456789", "abc"))
    assert output.taken() == "\r\x1b[2A012…\x1b[K\r\nabc\x1b[K\x1b[J"


def test_what_is_left_stays() -> None:
    screen, output, _ = made()
    screen.begin()
    screen.draw([], frame("one"))
    screen.leave()
    screen.draw([], frame("one"))
    screen.end()
    assert output.taken() == "\x1b[?25l\rone\x1b[K\x1b[J\r\n\rone\x1b[K\x1b[?25h"
