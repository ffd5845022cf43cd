"""The page of `btc run --watch`, `btc edit` and `btc watch` needs no extra: only what the plain install has."""

from __future__ import annotations

import subprocess
import sys
import tomllib
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
PAGES = ("local_page", "recordings", "editor")
_MODULES = {"argon2-cffi": "argon2", "msgpack": "msgpack", "pillow": "PIL", "psycopg[binary]": "psycopg",
            "pyserial": "serial", "PyYAML": "yaml", "pyzmq": "zmq"}  # fmt: skip


def extras() -> list[str]:
    """Return the modules that only extras bring."""
    project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    names = {line.split(">=")[0] for name in ("server", "groot", "maps", "mcp", "pictures", "postgres", "serial")
             for line in project["optional-dependencies"][name]}  # fmt: skip
    return sorted(_MODULES.get(name, name) for name in names)


@pytest.mark.parametrize("page", PAGES)
def test_a_page_needs_no_extra(page: str) -> None:
    blocked = "".join(f"sys.modules[{name!r}] = None; " for name in extras())
    program = f"import sys; {blocked}import btlang.server.page.{page}"
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
