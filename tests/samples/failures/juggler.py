"""A word with a mistake."""

from collections.abc import Iterator


def juggle(count: float = 1) -> Iterator[None]:
    """Throws the balls up, one after the other, and one more than there are."""
    balls = ["ball"] * round(count)
    yield
    for _ in range(round(count) + 1):
        balls.pop()
        yield
