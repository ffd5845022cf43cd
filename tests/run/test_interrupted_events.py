"""Events that Ctrl-C interrupts anywhere: what comes behind them still ends."""

from __future__ import annotations

import sys
import threading
from types import FrameType
from typing import Any

from btlang.run import bus, recent
from btlang.run.bus import Bus
from btlang.run.events import Said
from btlang.run.recent import RecentEvents

HANDS_ON = {bus.__file__, recent.__file__, threading.__file__}


def is_interrupted(stream: Bus, at: int) -> bool:
    """Emits an event, with Ctrl-C at one of the calls or returns of what hands it on; whether it came so far."""
    seen = 0

    def trace(frame: FrameType, event: str, _: Any) -> Any:
        nonlocal seen
        if frame.f_code.co_filename not in HANDS_ON:
            return None
        seen += event in ("call", "return")  # where Python looks for signals
        if seen == at:
            sys.settrace(None)
            raise KeyboardInterrupt
        return trace

    before = sys.gettrace()
    sys.settrace(trace)
    try:
        stream.emit(Said, "hi")
    except KeyboardInterrupt:
        return True
    finally:
        sys.settrace(before)
    return False


def test_a_run_that_ctrl_c_interrupts_while_it_tells_something_still_ends() -> None:
    at, is_cut = 0, True
    while is_cut:
        at += 1
        stream, kept, told = Bus(queued=True), RecentEvents(), list[Any]()
        stream.add(kept)
        stream.add(told.append)
        is_cut = is_interrupted(stream, at)

        def end(stream: Bus = stream, kept: RecentEvents = kept) -> None:
            kept.close()
            list(kept.events())

        others = threading.Thread(target=end, daemon=True)
        others.start()
        others.join(5)
        assert not others.is_alive(), at
        closing = threading.Thread(target=stream.close, daemon=True)
        closing.start()
        closing.join(5)
        assert not closing.is_alive(), at
    assert at > 10
    assert len(told) == 1
