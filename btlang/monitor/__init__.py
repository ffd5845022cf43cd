"""Shows runs to Groot2, the editor of BehaviorTree.CPP, while they go on and afterwards."""
