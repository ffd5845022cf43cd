"""The live view as a sink: notes events in no time, and draws them in a thread of its own."""

from __future__ import annotations

import os
import sys
import threading
import time
from collections.abc import Callable, Mapping, Sequence
from contextlib import ExitStack, suppress

from btlang.run.bus import INLINE
from btlang.run.events import PeriodPassed
from btlang.run.live import frame
from btlang.run.live.board import Board
from btlang.run.live.keys import GONE, Keys, stoppable
from btlang.run.live.screen import LiveScreen, capture_output
from btlang.support.record import Record
from btlang.support.waker import Waker
from btlang.text.output import is_unicode

TYPE_CHECKING = False
if TYPE_CHECKING:
    from types import TracebackType
    from typing import Any, TextIO

    from btlang.run.controls import Controls
    from btlang.run.events import Event
    from btlang.run.live.board import Map, Viewed
    from btlang.run.snapshot import RunState
    from btlang.run.world_input import WorldInput


_INTERVAL = 0.2  # seconds between two frames
_LATEST = 0.1  # seconds after which a frame does not wait any longer for the end of a period
_TICK = 0.01  # seconds: a tick follows a period at once, and is over by then as a rule; the run then sleeps
_SHARE = 40  # a frame that took long to make is followed by a rest of so many times as long
_LONGEST_REST = 1.0
_LONGEST_ANSWER = 200
_MAP = "map"  # what a key is for
_GRACE = 2.0  # seconds after a question in which keys still belong to its answer
_SWITCH = 0.0005  # seconds after which the drawing thread lets a run that is waiting go on
_OTHER_LINES = 6  # one row in so many shows what happened, above the frame


class ViewKey(Record):
    """A key: how it is shown, what it does in words, and what each key calls (see Keys)."""

    shown: str
    does: str
    calls: Mapping[str, Callable[[], Any]]


def usual_keys(controls: Controls) -> list[ViewKey]:
    """Return the keys of a run that goes on; the pause comes first."""
    return [
        ViewKey("space", "pause", {" ": controls.toggle}),
        ViewKey("s", "step", {"s": controls.step}),
        ViewKey("q", "stop", {"q": controls.stop}),
        ViewKey("e", "emergency stop", {"e": controls.emergency_stop}),
    ]


class LiveView:
    """A sink for one run, between `with` and its end.

    It shows the tree at the end of what the terminal shows, and above it the lines that `Lines` writes, which stay; the
    tree stays too unless `tree_stays` is false. While the robot asks something, keys are the answer that `world_input`
    gets; v makes a visitor come. The `keys` of `keyboard`, where there is one, are by default space, s,
    q and e, which pause, step and stop the run, and stop the robot at once; ? explains the signs. With `type_ahead`, a
    space is the only key that does so while the mission runs: that list gets any other key, and what follows it. What
    is printed to standard output, or to a standard error on a terminal, comes above the tree. Raises EngineError for a
    tree that cannot be compiled.
    """

    policy = INLINE

    def __init__(
        self,
        mission: Viewed,
        controls: Controls,
        output: TextIO,
        keyboard: TextIO | None = None,
        tree_stays: bool = True,
        type_ahead: list[str] | None = None,
        keys: Sequence[ViewKey] | None = None,
        world_input: WorldInput | None = None,
    ) -> None:
        self._board = Board(mission, frame.UNICODE if is_unicode(output) else frame.ASCII)
        self._tree_stays = tree_stays
        self._type_ahead = type_ahead
        self._controls = controls
        self._output = output
        self._screen = LiveScreen(output, lambda: os.get_terminal_size(output.fileno()))
        own = [ViewKey("m", _MAP, {"m": self._hide_map}), ViewKey("?", "legend", {"?": self._explain})]
        used = [*(usual_keys(controls) if keys is None else keys), *own]
        self._shown_keys = [(key.shown, key.does) for key in used]
        self._calls = {GONE: controls.stop}
        for key in used:
            self._calls.update(key.calls)
        self._world_input, self._typed, self._asked = world_input, "", -_GRACE
        if world_input is not None:
            self._calls.setdefault("v", world_input.invite)
        self._keys = self._open_keys(keyboard)
        self._due = 0.0  # when the next frame may be drawn
        self._waker = Waker()
        self._drawing = threading.RLock()
        self._drawn: object = None  # what the last frame was made from
        self._explained = False  # what the signs mean
        self._left = False  # for as long as the process is stopped
        self._behind = False  # the process is or was in the background, where it neither draws nor reads
        self._ended = False
        self._thread = threading.Thread(target=self._draw_on, name="btlang live view", daemon=True)
        self._exits = ExitStack()

    @property
    def unicode(self) -> bool:
        """Return whether the terminal has more than the signs of ASCII."""
        return self._board.signs is frame.UNICODE

    def show_map(self, world: Map | None) -> None:
        """Show the world beside the tree, or below it, while the mission runs; m hides and shows it."""
        self._board.map = world

    def __call__(self, event: Event) -> None:
        """Note an event."""
        self._board.note(event)
        if isinstance(event, PeriodPassed) and time.monotonic() >= self._due:
            self._waker.wake()

    def jump(self, state: RunState) -> None:
        """Go on from another state of the run."""
        self._board.jump(state)
        self._waker.wake()

    def __enter__(self) -> LiveView:
        with ExitStack() as exits:
            exits.callback(self._screen.end)
            self._screen.begin()
            if self._keys is not None:
                exits.callback(self._keys.end)
                self._keys.begin()
            exits.callback(self._finish)
            exits.callback(sys.setswitchinterval, sys.getswitchinterval())
            sys.setswitchinterval(_SWITCH)
            exits.enter_context(capture_output(self._output, self._board.note))
            exits.enter_context(stoppable(self._leave, self._come_back))
            self._thread.start()
            self._exits = exits.pop_all()
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self._exits.close()

    def _draw_on(self) -> None:
        rest = 0.0
        while not self._ended:
            self._waker.sleep(rest + _LATEST)
            time.sleep(_TICK)  # so that drawing takes no time from it
            if self._left or not self._in_front:
                self._behind = True
                continue
            began = time.monotonic()
            try:
                with self._drawing:
                    if self._behind:
                        self._come_back()
                    self._draw()
            except (OSError, ValueError):  # the terminal is gone; the run is not
                return
            now = time.monotonic()
            rest = min(max(_INTERVAL, _SHARE * (now - began)), _LONGEST_REST)
            self._due = now + rest

    def _draw(self) -> None:
        """Draw a frame where there is anything new."""
        width, height = self._screen.size()
        doing = self._doing()
        question = self._question
        seen = self._board.changes, width, height, doing, self._explained, question, self._typed, self._board.hides_map
        if seen == self._drawn:
            return
        self._drawn = seen
        above = self._board.take()
        lines = self._board.frame(
            width, height - max(height // _OTHER_LINES, 1), doing, self._keys_shown(doing), self._explained
        )
        if question and doing:
            lines[-1] = frame.prompt_line(question, self._typed, width, self._board.signs)
        self._screen.draw(above, lines)

    def _keys_shown(self, doing: str) -> Sequence[tuple[str, str]]:
        """Return the keys as frame.keys_line takes them."""
        if self._keys is None:
            return frame.SIGNALS
        typing = self._type_ahead is not None and doing != "paused"
        shown = [key for key in self._shown_keys if key[1] != _MAP or self._board.map is not None]
        return (shown[0], *frame.SIGNALS) if typing else shown

    def _doing(self) -> str:
        if self._ended:
            return ""
        if self._controls.emergency:
            return "emergency stop"
        return "stopping" if self._controls.stopped else "paused" if self._controls.paused else "running"

    @property
    def _in_front(self) -> bool:
        return self._keys is None or self._keys.in_front

    def _finish(self) -> None:
        self._ended = True
        self._waker.wake()
        if self._thread.ident is not None:
            self._thread.join()
        try:
            with self._drawing:
                if self._tree_stays:
                    self._draw()
                else:
                    self._screen.draw(self._board.take(), [])
                self._screen.leave()
        except (OSError, ValueError):  # as above
            return

    def _open_keys(self, keyboard: TextIO | None) -> Keys | None:
        try:
            return Keys(keyboard.fileno(), self._press) if keyboard is not None and keyboard.isatty() else None
        except (OSError, ValueError):
            return None

    @property
    def _question(self) -> str:
        """Return what the robot asks and somebody at this keyboard can answer."""
        return self._world_input.question if self._world_input is not None and self._keys is not None else ""

    def _takes_answers(self) -> bool:
        """Return whether keys are an answer: also when the question has just gone, so that its rest stops no robot."""
        now = time.monotonic()
        self._asked = now if self._question else self._asked
        return now - self._asked < _GRACE or bool(self._typed)

    def _answer(self, key: str) -> None:
        """Take a key of the answer; Enter sends it."""
        if key in "\r\n":
            if self._typed and self._question and self._world_input is not None:
                self._world_input.type(self._typed)
            self._typed = ""
        elif key in "\x7f\b":
            self._typed = self._typed[:-1]
        elif key.isprintable() and len(key) == 1 and len(self._typed) < _LONGEST_ANSWER:
            self._typed += key
        self._waker.wake()

    def _press(self, key: str) -> None:
        controls = self._controls
        if key and not controls.paused and self._takes_answers():
            self._answer(key)
            return
        if key and self._type_ahead is not None and not controls.paused and (key != " " or self._type_ahead):
            self._type_ahead.append(key)
            return
        call = self._calls.get(key.lower())
        if call is not None:
            call()
            self._waker.wake()

    def _explain(self) -> None:
        self._explained = not self._explained

    def _hide_map(self) -> None:
        self._board.hides_map = not self._board.hides_map

    def _leave(self) -> None:
        """Give the terminal back for as long as the process is stopped."""
        with self._drawing:
            self._left = True
            self._screen.leave()
            self._screen.end()
            if self._keys is not None:
                self._keys.restore()

    def _come_back(self) -> None:
        with self._drawing, suppress(OSError, ValueError):  # a terminal that is gone sends this signal too
            self._left, self._drawn = False, None
            self._behind = not self._in_front
            self._screen.begin()
            if self._keys is not None:
                self._keys.begin()
