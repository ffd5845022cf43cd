"""What was wrong with an input: data here, prose in `codes`, layout in `render`."""
