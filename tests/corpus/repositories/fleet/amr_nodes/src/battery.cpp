#include "amr_nodes/battery.hpp"
namespace amr
{
BT::PortsList DockAt::providedPorts()
{
  BT::PortsList ports;
  ports.insert(BT::InputPort<std::string>("station"));
  ports.insert(BT::InputPort<int>("retries", 3, "how often to try"));
  ports.insert(BT::OutputPort<int>("error_code"));
  return ports;
}

BT::PortsList Blink::providedPorts()
{
  return { BT::InputPort<std::string>("color"), BT::InputPort<unsigned>("times", 1, "how often") };
}

BT::NodeStatus Blink::tick()
{
  std::string color;
  if (!getInput("color", color)) { throw BT::RuntimeError("missing color"); }
  unsigned times = 1;
  getInput("times", times);
  return BT::NodeStatus::SUCCESS;
}
}  // namespace amr
