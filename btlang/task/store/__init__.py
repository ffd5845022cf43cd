"""What the task layer remembers: the records, and the databases that keep them."""
