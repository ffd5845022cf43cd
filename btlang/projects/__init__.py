"""`btc check`: trees in XML as the project of a team, checked by the models of their nodes, wherever they will run."""
