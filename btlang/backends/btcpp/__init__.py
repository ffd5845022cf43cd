"""Trees as XML of BehaviorTree.CPP."""

from btlang.backends.btcpp.writer import to_xml

__all__ = ["to_xml"]
