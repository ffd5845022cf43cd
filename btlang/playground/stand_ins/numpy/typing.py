"""The types of arrays, for annotations alone."""

from __future__ import annotations

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any


class NDArray:
    """An annotation of an array with a type of its entries."""

    def __class_getitem__(cls, entries: Any) -> type:
        return cls
