"""Robots with components, for tests."""

from __future__ import annotations

import shutil
from pathlib import Path

from btlang.vocabulary.shipped import STANDARD_BODY

SAMPLES = Path(__file__).parent / "samples"


def robot_file(folder: Path, more: str) -> str:
    """The standard robot with more in its file, beside the samples. Where a folder has them, their words stay read."""
    for sample in SAMPLES.iterdir():
        if sample.is_file() and not (folder / sample.name).exists():
            shutil.copy(sample, folder)
    path = folder / "robot.toml"
    standard = Path(STANDARD_BODY).read_text(encoding="utf-8")
    path.write_text(f"{standard}\n{more}", encoding="utf-8")
    return str(path)


def machine(**keys: object) -> str:
    """The table of the coffee machine."""
    lines = {"name": '"machine"', "class": '"coffee:Machine"', **keys}
    return "\n".join(["[[component]]", *(f"{key} = {value}" for key, value in lines.items())])
