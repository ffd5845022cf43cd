"""What a text names, found before its lines are read: includes, facts, definitions, values and their scopes."""
