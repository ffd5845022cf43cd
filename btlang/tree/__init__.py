"""Trees: the syntax tree of English, the typed tree that every back end reads, and tools for both."""
