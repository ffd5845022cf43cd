"""What an editor asks of a text: its tree and outline, help on its words, completions, names, phrases to put in."""
