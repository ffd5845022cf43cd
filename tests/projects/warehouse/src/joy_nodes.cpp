#include <behaviortree_cpp/bt_factory.h>
class DriveByJoy : public BT::StatefulActionNode {
public:
  static BT::PortsList providedPorts() {
    return { BT::InputPort<bool>("deadman", true, "needs the dead man's switch"),
             BT::InputPort<double>("scale", 1.0, "factor") };
  }
};
class JoyConnected : public BT::ConditionNode {
public:
  static BT::PortsList providedPorts() { return {}; }
};
BT_REGISTER_NODES(factory) {
  factory.registerNodeType<DriveByJoy>("DriveByJoy");
  factory.registerNodeType<JoyConnected>("JoyConnected");
}
