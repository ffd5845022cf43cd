"""XML of BehaviorTree.CPP, format 4 and the older dialect, to trees. Imported only when an XML text is read."""
