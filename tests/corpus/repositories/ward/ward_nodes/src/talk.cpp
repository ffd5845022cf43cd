#include <behaviortree_cpp/bt_factory.h>
#include "ward_nodes/doors.hpp"

namespace ward
{
// A template of messages, filled in with the name of the patient.
class Announce : public BT::SyncActionNode
{
public:
  using BT::SyncActionNode::SyncActionNode;

  static BT::PortsList providedPorts()
  {
    BT::PortsList ports;
    ports.insert(BT::InputPort<std::string>("text"));
    ports.insert(BT::InputPort<std::string>("language", "en", "en or de"));
    ports.insert(BT::InputPort<int>("volume"));
    return ports;
  }

  BT::NodeStatus tick() override
  {
    std::string text;
    if (!getInput("text", text)) {
      throw BT::RuntimeError("no text");
    }
    int volume = 70;
    getInput("volume", volume);  // as it was, where it isn't given
    return speak(text, volume) ? BT::NodeStatus::SUCCESS : BT::NodeStatus::FAILURE;
  }
};

class NextPatient : public BT::SyncActionNode
{
public:
  using BT::SyncActionNode::SyncActionNode;
  static BT::PortsList providedPorts()
  {
    return { BT::OutputPort<std::string>("patient"), BT::OutputPort<int>("room") };
  }
  BT::NodeStatus tick() override;
};
}  // namespace ward

BT_REGISTER_NODES(factory)
{
  factory.registerNodeType<ward::OpenDoor>("OpenDoor");
  factory.registerNodeType<ward::IsDoorOpen>("IsDoorOpen");
  factory.registerNodeType<ward::CallLift>("CallLift");
  factory.registerNodeType<ward::Announce>("Announce");
  factory.registerNodeType<ward::NextPatient>("NextPatient");
}
