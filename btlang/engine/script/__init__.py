"""The script language of BehaviorTree.CPP."""
