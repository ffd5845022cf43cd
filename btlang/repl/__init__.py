"""The mission at the keyboard: `btc` alone. `draft` holds what was entered, `screen` draws it, `loop` runs it."""
