"""Which rows are shown where there is no room for all."""

from __future__ import annotations

from hypothesis import given
from hypothesis import strategies as st

from btlang.engine.status import FAILURE, IDLE, RUNNING, SUCCESS
from btlang.run.live.selection import LEAST_HEIGHT, Row, choose_rows, focus
from btlang.run.snapshot import HALTED, SUSPENDED, Shape

from .trees import SHAPES, shape_of

LETTERS = {".": IDLE, "r": RUNNING, "s": SUCCESS, "f": FAILURE, "h": HALTED, "p": SUSPENDED}
MANY = 500


def told(shape: Shape, statuses: bytes, height: int) -> list[str]:
    """The rows as text: number of the node, or what is left out."""
    rows = choose_rows(shape, bytearray(statuses), height)
    assert len(rows) <= height
    return [" " * row.depth + words(row) for row in rows]


def words(row: Row) -> str:
    if row.node < 0:
        return ", ".join(f"{count} {kind}" for kind, count in row.left_out)
    return f"{row.node}" + (f" +{row.inside}" if row.inside else "")


def statuses_of(letters: str) -> bytes:
    return bytes(LETTERS[letter] for letter in letters)


def test_what_fits_is_shown_whole() -> None:
    shape = shape_of("root\n a\n  b\n c")
    assert told(shape, statuses_of("...."), 4) == ["0", " 1", "  2", " 3"]


def test_a_long_row_is_shown_around_what_runs() -> None:
    shape = Shape([-1] + [0] * (MANY - 1))
    statuses = bytes([RUNNING] + [SUCCESS] * 199 + [RUNNING] + [IDLE] * (MANY - 201))
    assert told(shape, statuses, 8) == ["0", " 197 done", " 198", " 199", " 200", " 201", " 202", " 297 to come"]


def test_the_ends_of_a_row() -> None:
    shape = Shape([-1] + [0] * (MANY - 1))
    first = bytes([RUNNING, RUNNING] + [IDLE] * (MANY - 2))
    last = bytes([RUNNING] + [SUCCESS] * (MANY - 2) + [RUNNING])
    assert told(shape, first, 5) == ["0", " 1", " 2", " 3", " 496 to come"]
    assert told(shape, last, 5) == ["0", " 496 done", " 497", " 498", " 499"]


def test_finished_branches_are_folded_up() -> None:
    branch = " b\n  x\n  y\n  z\n"
    shape = shape_of("root\n" + branch * 3)
    statuses = statuses_of("r" + "ssss" + "rsr." + "....")
    assert told(shape, statuses, 7) == ["0", " 1 +3", " 5", "  6", "  7", "  8", " 9 +3"]
    assert told(shape, statuses, 12) == ["0", " 1 +3", " 5", "  6", "  7", "  8", " 9", "  10", "  11", "  12"]


def test_levels_between_are_left_out() -> None:
    chain = Shape(range(-1, 9999))
    running = bytes([RUNNING] * 10_000)
    assert told(chain, running, 5) == ["0", " 9996 levels", " 9997", "  9998", "   9999"]
    assert told(chain, running, 3) == ["0", " 9998 levels", " 9999"]


def test_no_row_stands_for_a_single_node() -> None:
    shape = shape_of("root\n a\n b\n c\n  d\n e")
    assert told(shape, statuses_of("rssrr."), 5) == ["0", " 2 done", " 3", "  4", " 5"]
    assert told(shape, statuses_of("rssrr."), 6)[1:3] == [" 1", " 2"]


def test_before_the_start_and_after_a_failure() -> None:
    shape = shape_of("root\n a\n  x\n  y\n b\n  x\n  y\n c")
    assert told(shape, statuses_of("........"), 4) == ["0", " 1 +2", " 4 +2", " 7"]
    assert told(shape, statuses_of("fsssfsf."), 6) == ["0", " 1 +2", " 4", "  5", "  6", " 7"]
    assert focus(shape, bytearray(statuses_of("fsssfsf.")), 6) == [6]


def test_a_part_of_what_is_too_long_to_be_opened() -> None:
    shape = Shape([-1, 0] + [1] * MANY)
    assert told(shape, bytes([IDLE] * (MANY + 2)), 6) == ["0", " 1", "  2", "  3", "  4", "  497 to come"]


def test_many_run_at_once() -> None:
    shape = Shape([-1] + [0] * MANY)
    assert told(shape, bytes([RUNNING] * (MANY + 1)), 6) == ["0", " 1", " 2", " 3", " 4", " 496 running"]


@st.composite
def cases(draw: st.DrawFn) -> tuple[Shape, bytearray, int]:
    """A shape, statuses in which what is above a running node runs too, and a height."""
    shape = draw(SHAPES)
    statuses = bytearray(
        draw(st.lists(st.sampled_from(list(LETTERS.values())), min_size=len(shape), max_size=len(shape)))
    )
    for node in range(len(shape) - 1, 0, -1):
        if statuses[node] == RUNNING:
            statuses[shape.parents[node]] = RUNNING
    return shape, statuses, draw(st.integers(LEAST_HEIGHT, 40))


@given(cases())
def test_whatever_the_tree_the_rows_fit_and_stand_for_all(case: tuple[Shape, bytearray, int]) -> None:
    shape, statuses, height = case
    rows = choose_rows(shape, statuses, height)
    assert len(rows) <= height
    nodes = [row.node for row in rows if row.node >= 0]
    assert nodes == sorted(set(nodes))
    next_node = 0  # each node is a row, is inside of one, or is left out between two
    for row in rows:
        if row.node < 0:
            assert row.left_out
            following = next((other.node for other in rows[rows.index(row) + 1 :] if other.node >= 0), len(shape))
            next_node = following
        else:
            assert row.node == next_node
            next_node = row.node + 1 + row.inside
    assert next_node == len(shape)
    depths = {row.node: row.depth for row in rows if row.node >= 0}
    for node, depth in depths.items():
        parent = shape.parents[node]
        while parent >= 0 and parent not in depths:
            parent = shape.parents[parent]
        assert depth == (depths[parent] + 1 if parent >= 0 else 0)


@given(cases())
def test_what_runs_comes_first(case: tuple[Shape, bytearray, int]) -> None:
    shape, statuses, height = case
    shown = {row.node for row in choose_rows(shape, statuses, height)}
    running = [
        node
        for node in range(len(shape))
        if statuses[node] == RUNNING and RUNNING not in statuses[node + 1 : shape.ends[node]]
    ]
    if not running:
        return
    deepest = max(shape.depths[node] for node in running)
    assert any(node in shown and shape.depths[node] == deepest for node in running)
    if 3 * len(running) + 2 <= height:
        assert set(running) <= shown
    if len(shape) <= height:
        assert shown == set(range(len(shape)))
