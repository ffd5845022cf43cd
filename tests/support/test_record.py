"""Records: frozen values with slots."""

from __future__ import annotations

import pickle
from copy import deepcopy

import pytest

from btlang.support.record import Record


class Pair(Record, uncompared=("right",)):
    left: int
    right: str = "r"


class Triple(Pair):
    third: tuple[object, ...] = ()


class Same(Triple):
    """No fields of its own."""


def test_fields_in_order_with_defaults_and_names() -> None:
    triple = Triple(1, third=(2,))
    assert (triple.left, triple.right, triple.third) == (1, "r", (2,))
    assert Triple.fields == ("left", "right", "third")
    assert repr(triple) == "Triple(left=1, right='r', third=(2,))"


@pytest.mark.parametrize("wrong", [(), (1, "r", (), 4)])
def test_wrong_arguments_are_refused(wrong: tuple[object, ...]) -> None:
    with pytest.raises(TypeError):
        Triple(*wrong)  # type: ignore[arg-type]


@pytest.mark.parametrize("kind", [Pair, Triple, Same])
def test_frozen(kind: type[Pair]) -> None:
    record = kind(1)
    assert type(record) is kind
    with pytest.raises(AttributeError, match=f"{kind.__name__} is frozen: cannot set left"):
        record.left = 2  # type: ignore[misc]
    with pytest.raises(AttributeError, match="cannot delete left"):
        del record.left
    with pytest.raises(AttributeError):
        record.new = 2  # type: ignore[attr-defined]
    assert not hasattr(record, "__dict__")


def test_equal_by_class_and_compared_fields() -> None:
    assert Pair(1, "a") == Pair(1, "b")
    assert hash(Pair(1, "a")) == hash(Pair(1, "b"))
    assert Pair(1) != Pair(2)
    assert Triple(1) != Same(1)


def test_copies() -> None:
    same = Same(1, "x", (Pair(2),))
    assert same.replace(left=3).left == 3
    for copy in (deepcopy(same), pickle.loads(pickle.dumps(same))):
        assert type(copy) is Same
        assert (copy.left, copy.right, copy.third) == (1, "x", (Pair(2),))


@pytest.mark.parametrize("given", [((), {}), ((1, 2, 3), {}), ((1,), {"other": 2}), ((1,), {"left": 2})])
def test_the_first_instance_is_refused_like_any_other(given: tuple[tuple[int, ...], dict[str, int]]) -> None:
    class Fresh(Record):
        left: int
        right: int = 0

    for _ in range(2):
        with pytest.raises(TypeError, match=r"__new__\(\)"):
            Fresh(*given[0], **given[1])
    assert (Fresh(1).left, Fresh(left=1, right=2).right) == (1, 2)
    assert type(Fresh(1)) is Fresh


def test_the_first_instance_may_have_a_field_of_any_name() -> None:
    class Fresh(Record):
        kind: int
        values: int
        named: int

    fresh = Fresh(kind=1, values=2, named=3)
    assert (fresh.kind, fresh.values, fresh.named) == (1, 2, 3)
