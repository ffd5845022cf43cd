"""The server's HTTP side: routes, access, the API's description and the process that listens."""
