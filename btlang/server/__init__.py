"""The representative server: the door to robots for everything outside this computer."""
