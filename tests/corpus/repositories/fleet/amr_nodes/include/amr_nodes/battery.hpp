#pragma once
#include <behaviortree_cpp/condition_node.h>
namespace amr
{
class BatteryAbove : public BT::ConditionNode
{
public:
  BatteryAbove(const std::string& name, const BT::NodeConfig& config);
  static BT::PortsList providedPorts() { return { BT::InputPort<double>("percent") }; }
  BT::NodeStatus tick() override;
};
class ReadBattery : public BT::SyncActionNode
{
public:
  ReadBattery(const std::string& name, const BT::NodeConfig& config);
  static BT::PortsList providedPorts() { return { BT::OutputPort<double>("percent") }; }
  BT::NodeStatus tick() override;
};
class PathClear : public BT::ConditionNode
{
public:
  PathClear(const std::string& name, const BT::NodeConfig& config);
  static BT::PortsList providedPorts() { return { BT::InputPort<double>("distance", 1.0, "how far ahead, in m") }; }
  BT::NodeStatus tick() override;
};
class DockAt : public BT::StatefulActionNode
{
public:
  DockAt(const std::string& name, const BT::NodeConfig& config);
  static BT::PortsList providedPorts();
  BT::NodeStatus onStart() override;
  BT::NodeStatus onRunning() override;
  void onHalted() override;
};
class Blink : public BT::SyncActionNode
{
public:
  Blink(const std::string& name, const BT::NodeConfig& config);
  static BT::PortsList providedPorts();
  BT::NodeStatus tick() override;
};
}  // namespace amr
