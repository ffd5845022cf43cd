#pragma once
#include <behaviortree_cpp/action_node.h>
#include <behaviortree_cpp/condition_node.h>

namespace ward
{
class OpenDoor : public BT::StatefulActionNode
{
public:
  OpenDoor(const std::string& name, const BT::NodeConfig& config) : BT::StatefulActionNode(name, config) {}

  static BT::PortsList providedPorts()
  {
    return {
      BT::InputPort<std::string>("door", "name of the door"),
      BT::InputPort<double>("patience", 20.0, "seconds"),
      BT::OutputPort<int>("attempts", "how often it was asked"),
    };
  }

  BT::NodeStatus onStart() override;
  BT::NodeStatus onRunning() override;
  void onHalted() override;
};

class IsDoorOpen : public BT::ConditionNode
{
public:
  IsDoorOpen(const std::string& name, const BT::NodeConfig& config) : BT::ConditionNode(name, config) {}

  static BT::PortsList providedPorts()
  {
    return { BT::InputPort<std::string>("door") };
  }

  BT::NodeStatus tick() override;
};

class CallLift : public BT::StatefulActionNode
{
public:
  using BT::StatefulActionNode::StatefulActionNode;

  static BT::PortsList providedPorts()
  {
    return { BT::InputPort<int>("floor"), BT::InputPort<std::string>("lift", "A", "which lift"),
             BT::OutputPort<bool>("came") };
  }

  BT::NodeStatus onStart() override;
  BT::NodeStatus onRunning() override;
  void onHalted() override;
};
}  // namespace ward
