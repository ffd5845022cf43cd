"""Trees for py_trees 2.6: `build.py` makes them, `module.py` writes a module that does; `plan.py` tells of what."""
