"""What may follow at the end of a text."""
