"""Messages about inputs: diagnostics as data, their codes and texts, and how they are reported."""
