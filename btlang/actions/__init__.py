"""The actions and conditions that ship: leaves that talk to a robot. Keyword files name them by `call`."""
