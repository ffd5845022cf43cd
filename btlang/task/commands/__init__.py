"""Commands: how they reach a robot that is up, what they do and what is answered."""
