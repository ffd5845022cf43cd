"""Cameras, microphones and speakers of this computer, and files in their place."""
