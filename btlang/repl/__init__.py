"""The mission at the keyboard: `btc` alone. `session` holds what was entered, `screen` draws it, `loop` runs it."""
