"""Why words cannot be read, and the rule for the spelling of what is proposed in their place."""
