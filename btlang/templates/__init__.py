"""Projects to begin with: `btc new`."""
