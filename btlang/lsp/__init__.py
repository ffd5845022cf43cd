"""`btc lsp`: a language server (LSP) for missions, their tests, TOML files and trees in XML."""
