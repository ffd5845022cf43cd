"""What the task layer says of a mission that was skipped as a whole."""

from __future__ import annotations

from pathlib import Path

from btlang.task.execution import executor
from btlang.task.store.records import FINAL

from .layers import layer_in, submit, wait_for


def test_only_what_was_skipped_had_nothing_to_do(tmp_path: Path, place: str) -> None:
    with layer_in(tmp_path, store=place) as layer:
        reasons = [wait_for(layer, submit(layer, text), *FINAL).reason for text in ("print hello", "if bumped, wave")]
    assert reasons == ["", executor.NOTHING_TO_DO]
