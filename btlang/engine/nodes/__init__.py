"""Control nodes, decorators and built-in leaves: what each does, as in BehaviorTree.CPP 4.10."""
