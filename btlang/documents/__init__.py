"""`btc compile --to markdown`: pages about trees, for people who review them."""
