"""The representative server: how everything outside this computer reaches robots."""
