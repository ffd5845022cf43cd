#pragma once
#include <behaviortree_cpp/action_node.h>
#include <geometry_msgs/msg/pose_stamped.hpp>

namespace amr
{
// Asks the fleet manager for the next order.
class FetchOrder : public BT::StatefulActionNode
{
public:
  FetchOrder(const std::string& name, const BT::NodeConfig& config) : BT::StatefulActionNode(name, config) {}

  static BT::PortsList providedPorts()
  {
    return {
      BT::InputPort<std::string>("fleet", "main", "name of the fleet"),
      BT::OutputPort<geometry_msgs::msg::PoseStamped>("pickup"),
      BT::OutputPort<geometry_msgs::msg::PoseStamped>("dropoff"),
      BT::OutputPort<std::string>("order_id", "id of the order"),
      BT::OutputPort<int>("priority"),
    };
  }
  BT::NodeStatus onStart() override;
  BT::NodeStatus onRunning() override;
  void onHalted() override;
};

class ReportOrder : public BT::SyncActionNode
{
public:
  using BT::SyncActionNode::SyncActionNode;
  static BT::PortsList providedPorts()
  {
    return { BT::InputPort<std::string>("order_id"), BT::InputPort<std::string>("state") };
  }
  BT::NodeStatus tick() override;
};

class LiftFork : public BT::StatefulActionNode
{
public:
  using BT::StatefulActionNode::StatefulActionNode;
  static BT::PortsList providedPorts()
  {
    return { BT::InputPort<double>("height", "in m"), BT::InputPort<double>("speed", 0.1, "in m/s"),
             BT::OutputPort<double>("load", "kg") };
  }
  BT::NodeStatus onStart() override;
  BT::NodeStatus onRunning() override;
  void onHalted() override;
};
}  // namespace amr
