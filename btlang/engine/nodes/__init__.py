"""The built-in nodes: control nodes, decorators and leaves, each as in BehaviorTree.CPP 4.10."""
