"""Who may use the server: users, sessions, tokens, passwords and the certificate."""
