"""Trees as English: a mission that compiles to an equal tree."""

from btlang.backends.english.target import to_english

__all__ = ["to_english"]
