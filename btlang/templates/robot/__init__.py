"""The robot "gadget": its robot file, its world and its missions."""
