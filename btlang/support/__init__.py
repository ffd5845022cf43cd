"""What all other rooms use: frozen values, the user's folders, Ctrl-C and Python's garbage collector."""
