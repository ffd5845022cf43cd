"""Source text, places in it, words, and spelling suggestions."""
