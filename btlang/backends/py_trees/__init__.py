"""Trees for py_trees 2.6: `plan.py` plans them, `build.py` makes them, `module.py` writes a module that does.

`lift.py` goes the other way.
"""
