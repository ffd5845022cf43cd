"""The waist: the AST of English, the typed tree that every back end reads, and tools for both."""
