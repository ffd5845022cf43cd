"""What a pause says."""

from __future__ import annotations

from pathlib import Path

from .layers import ask, layer_in, submit, wait_until


def test_a_pause_says_what_was_under_way(tmp_path: Path) -> None:
    with layer_in(tmp_path) as layer:
        assert layer.handle({"command": "pause"}, "ann").text == "The robot is paused."
        ask(layer, "resume")
        number = submit(layer, "wait 1 h, meanwhile repeat forever: nod")
        wait_until(lambda: "nod" in layer.handle({"command": "status"}, "ann").text)
        for _ in range(2):  # also where it is paused already
            paused = layer.handle({"command": "pause"}, "ann")
            assert paused.text.startswith(f"The robot is paused. Task {number} was under way: ")
            assert paused.text.endswith(". It goes on with: btc robot resume")
            assert paused.data["task"] == number
            assert "nod" in paused.data["interrupted"]
        assert f"Task {number} was under way: " in layer.handle({"command": "status"}, "ann").text
        ask(layer, "resume")
        assert "was under way" not in layer.handle({"command": "status"}, "ann").text
