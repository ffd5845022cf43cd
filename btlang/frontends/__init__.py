"""Texts to trees: words become tokens, a matching stage groups them, one of two parsers builds the AST."""
