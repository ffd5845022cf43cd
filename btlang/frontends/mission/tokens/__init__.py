"""Words to raw tokens: phrases, connectives, names, brackets, lines and blocks."""
