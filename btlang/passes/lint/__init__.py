"""Lints: warnings about missions and trees that can run. Each module finds one of them."""
