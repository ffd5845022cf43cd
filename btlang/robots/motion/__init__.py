"""How a body of links moves: where its links are, what they touch, and plans that keep to all limits."""
