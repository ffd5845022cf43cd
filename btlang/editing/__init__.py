"""What an editor asks of a text: its tree and outline, help, completions, names, and changes by the tree."""
