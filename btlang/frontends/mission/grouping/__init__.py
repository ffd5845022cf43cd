"""Raw tokens to grouped tokens, which need no look-ahead any more."""
