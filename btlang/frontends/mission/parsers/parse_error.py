"""What a parser raises on tokens that it does not accept."""

from __future__ import annotations


class ParseError(Exception):
    """The tokens are no mission. The grouping stage lets none such through: seeing one is a bug of ours."""
