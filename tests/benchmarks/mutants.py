"""Small changes of modules on which safety and access depend, and which of them no test notices.

    python -m tests.benchmarks.mutants [--only access] [--at-once 2]

Each mutant is a module with one comparison turned, one constant moved, one `not` or one statement left out. The tests
of the module run on it in a copy of the checkout. Printed are the lines that survive: a test is missing there, unless
the change means the same (a longer wait between two looks, a text for people).
"""

from __future__ import annotations

import argparse
import ast
import os
import shutil
import subprocess
import sys
import tempfile
from collections.abc import Callable, Iterator
from concurrent.futures import ThreadPoolExecutor
from functools import partial
from itertools import islice
from pathlib import Path
from queue import Queue

ROOT = Path(__file__).parents[2]
_ACCESS = ["tests/server/test_access.py", "tests/server/test_attacks.py::test_wrong_passwords_cost_time"]
_GUARD = [f"tests/robots/motion/test_guard{part}.py" for part in ("", "_corridor", "_limits")]
MODULES = {
    "access": ("btlang/server/http/access.py", _ACCESS),
    "throttle": ("btlang/server/accounts/passwords.py", _ACCESS),
    "guard": ("btlang/robots/motion/guard/guard.py", _GUARD),
    "manager": ("btlang/task/execution/manager.py", ["tests/task/test_manager.py"]),
}
"""The modules, with the tests that are to notice."""
_TURNED: dict[type[ast.cmpop], type[ast.cmpop]] = {
    ast.Lt: ast.LtE, ast.LtE: ast.Lt, ast.Gt: ast.GtE, ast.GtE: ast.Gt, ast.Eq: ast.NotEq, ast.NotEq: ast.Eq,
    ast.Is: ast.IsNot, ast.IsNot: ast.Is, ast.In: ast.NotIn, ast.NotIn: ast.In,
}  # fmt: skip
_SECONDS = 120.0
_IGNORED = shutil.ignore_patterns("node_modules", "dist", "__pycache__")


def mutants(text: str) -> Iterator[tuple[int, str, str]]:
    """The line that is changed, what is done to it, and the module with that change."""
    whole = ast.parse(text)
    for at, node in enumerate(ast.walk(whole)):
        for number, _ in enumerate(_changes(node, whole)):
            tree = ast.parse(text)
            changed = next(islice(ast.walk(tree), at, None))
            what, change = next(islice(_changes(changed, tree), number, None))
            change()
            yield getattr(node, "lineno", 0), what, ast.unparse(ast.fix_missing_locations(tree))


def _changes(node: ast.AST, tree: ast.Module) -> Iterator[tuple[str, Callable[[], object]]]:
    if isinstance(node, ast.Compare) and type(node.ops[0]) in _TURNED:
        turned = _TURNED[type(node.ops[0])]
        yield f"{type(node.ops[0]).__name__} -> {turned.__name__}", lambda: node.ops.__setitem__(0, turned())
    elif isinstance(node, ast.BoolOp):
        other = ast.Or if isinstance(node.op, ast.And) else ast.And
        yield f"-> {other.__name__}", lambda: setattr(node, "op", other())
    elif isinstance(node, ast.UnaryOp) and isinstance(node.op, ast.Not):
        yield "no not", partial(setattr, node, "operand", ast.UnaryOp(ast.Not(), node.operand))
    elif isinstance(node, ast.BinOp) and isinstance(node.op, ast.Add | ast.Sub):
        other_op = ast.Sub if isinstance(node.op, ast.Add) else ast.Add
        yield f"-> {other_op.__name__}", lambda: setattr(node, "op", other_op())
    elif isinstance(node, ast.Constant) and isinstance(node.value, bool) and not _is_type_checking(node, tree):
        yield f"{node.value} -> {not node.value}", lambda: setattr(node, "value", not node.value)
    elif isinstance(node, ast.Constant) and isinstance(node.value, int | float):
        yield f"{node.value} -> {node.value + 1}", lambda: setattr(node, "value", node.value + 1)  # type: ignore[operator]
    elif isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef | ast.If | ast.For | ast.With | ast.AsyncWith):
        for place, inner in enumerate(node.body):
            is_call = isinstance(inner, ast.Expr) and not isinstance(inner.value, ast.Constant | ast.Yield)
            if is_call or isinstance(inner, ast.Raise | ast.AugAssign | ast.Continue | ast.Return):
                leave_out = partial(node.body.__setitem__, place, ast.Pass())
                yield f"without: {ast.unparse(inner)[:60]}", leave_out


def _is_type_checking(node: ast.Constant, tree: ast.Module) -> bool:
    return any(isinstance(each, ast.Assign) and each.value is node for each in tree.body)


def survivors(path: str, tests: list[str], at_once: int) -> tuple[int, list[str]]:
    """How many mutants there are, and those that no test notices."""
    text = (ROOT / path).read_text(encoding="utf-8")
    with tempfile.TemporaryDirectory() as folder:
        copies: Queue[Path] = Queue()
        for number in range(at_once):
            copy = Path(folder, str(number))
            for name in ("btlang", "tests", "keywords", "grammar", "examples"):
                shutil.copytree(
                    ROOT / name, copy / name, ignore=shutil.ignore_patterns("node_modules", "dist", "__pycache__")
                )
            for name in ("pyproject.toml", "hatch_build.py"):
                shutil.copy(ROOT / name, copy / name)
            copies.put(copy)

        def lives(mutant: tuple[int, str, str]) -> str:
            line, what, changed = mutant
            copy = copies.get()
            (copy / path).write_text(changed, encoding="utf-8")
            words = [sys.executable, "-m", "pytest", "-q", "-x", "-n0", "-p", "no:cacheprovider", *tests]
            environment = {**os.environ, "PYTHONDONTWRITEBYTECODE": "1"}
            try:
                done = subprocess.run(words, cwd=copy, capture_output=True, timeout=_SECONDS, env=environment)
                return f"{path}:{line}: {what}" if done.returncode == 0 else ""
            except subprocess.TimeoutExpired:
                return ""
            finally:
                (copy / path).write_text(text, encoding="utf-8")
                copies.put(copy)

        made = list(mutants(text))
        with ThreadPoolExecutor(at_once) as threads:
            return len(made), list(filter(None, threads.map(lives, [(0, "none", text), *made])))


def main() -> None:
    """Prints the survivors of each module."""
    parser = argparse.ArgumentParser()
    parser.add_argument("--only", choices=MODULES, action="append")
    parser.add_argument("--at-once", type=int, default=2)
    options = parser.parse_args()
    for name in options.only or MODULES:
        path, tests = MODULES[name]
        count, [unchanged, *alive] = survivors(path, tests, options.at_once)
        assert unchanged, "the tests fail without a change, too"
        print(f"{path}: {len(alive)} of {count} survive", *alive, sep="\n  ", flush=True)


if __name__ == "__main__":
    main()
