"""The emergency stop over the network, in a process of its own."""
