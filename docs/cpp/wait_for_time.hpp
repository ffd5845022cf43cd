// The node WaitForTime of btlang for BehaviorTree.CPP 4.10: an action that ends when the clock next shows a time of day.
//
//   CMakeLists.txt   find_package(behaviortree_cpp REQUIRED)
//                    target_link_libraries(my_robot behaviortree_cpp::behaviortree_cpp)  # without ROS 2: BT::behaviortree_cpp
//   once             factory.registerNodeType<btlang::WaitForTime>("WaitForTime");
//
// The clock is that of this computer, in its time zone. If it shows the time at the start, the node waits until tomorrow.

#pragma once

#include <cstdio>
#include <ctime>
#include <string>

#include <behaviortree_cpp/action_node.h>
#include <behaviortree_cpp/bt_factory.h>

namespace btlang
{
class WaitForTime : public BT::StatefulActionNode
{
public:
  WaitForTime(const std::string& name, const BT::NodeConfig& config) : BT::StatefulActionNode(name, config)
  {}

  static BT::PortsList providedPorts()
  {
    return { BT::InputPort<std::string>("time", "a time of day such as 18:30") };
  }

private:
  BT::NodeStatus onStart() override
  {
    const auto text = getInput<std::string>("time");
    int hour = 0;
    int minute = 0;
    if(!text || std::sscanf(text->c_str(), "%d:%d", &hour, &minute) != 2 || hour < 0 || hour > 23 || minute < 0 ||
       minute > 59)
    {
      throw BT::RuntimeError("time must be a time of day such as 18:30");
    }
    const std::time_t now = std::time(nullptr);
    std::tm day = *std::localtime(&now);
    day.tm_hour = hour;
    day.tm_min = minute;
    day.tm_sec = 0;
    day.tm_isdst = -1;
    due_ = std::mktime(&day);
    if(due_ <= now)
    {
      day.tm_mday += 1;
      day.tm_isdst = -1;
      due_ = std::mktime(&day);
    }
    return BT::NodeStatus::RUNNING;
  }

  BT::NodeStatus onRunning() override
  {
    return std::time(nullptr) < due_ ? BT::NodeStatus::RUNNING : BT::NodeStatus::SUCCESS;
  }

  void onHalted() override
  {}

  std::time_t due_ = 0;
};
}  // namespace btlang
