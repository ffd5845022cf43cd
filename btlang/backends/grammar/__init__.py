"""What missions of a vocabulary look like, for language models whose output is constrained by a grammar."""
