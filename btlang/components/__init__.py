"""The component layer: parts of a robot that are loaded by name and led through their life."""
