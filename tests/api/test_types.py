"""What type checkers say of scripts that use the library."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

from tests.profiles import only_long

SCRIPT = Path(__file__).parent / "samples" / "typed_script.py"
WRONG = {
    'repeat("wave", num_cycles="2", times=3)': 'Unexpected keyword argument "times"',
    "repeat('wave')": 'Missing named argument "num_cycles"',
    "sequence(3)": 'incompatible type "int"',
    "btlang.parse_tree(3)": 'incompatible type "int"',
    "Session().run(3)": 'incompatible type "int"',
    "btlang.nothing": 'has no attribute "nothing"',
    "cheer(1)": 'incompatible type "int"',
}


@only_long
def test_a_script_passes_mypy_strict_and_mistakes_do_not(tmp_path: Path) -> None:
    script = tmp_path / "script.py"
    good = SCRIPT.read_text(encoding="utf-8")
    script.write_text(good + "\n".join(WRONG), encoding="utf-8")
    mypy = [sys.executable, "-m", "mypy", "--strict", "--config-file=", f"--cache-dir={tmp_path / 'cache'}"]
    done = subprocess.run([*mypy, str(script)], capture_output=True, text=True, check=False)
    count = len(good.splitlines())
    lines = [line for line in done.stdout.splitlines() if ": error:" in line]
    assert [int(line.split(":")[1]) for line in lines] == [count + 1 + at for at in range(len(WRONG))], done.stdout
    assert all(said in line for line, said in zip(lines, WRONG.values(), strict=True)), done.stdout
