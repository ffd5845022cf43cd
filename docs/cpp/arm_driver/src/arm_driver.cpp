// A component of a robot in C++: the node /arm_driver, with the service ~/grip and the parameter `force`.

#include <chrono>
#include <memory>

#include "rclcpp/rclcpp.hpp"
#include "rclcpp_components/register_node_macro.hpp"
#include "rclcpp_lifecycle/lifecycle_node.hpp"
#include "std_msgs/msg/empty.hpp"
#include "std_srvs/srv/trigger.hpp"

namespace arm
{

using CallbackReturn = rclcpp_lifecycle::node_interfaces::LifecycleNodeInterface::CallbackReturn;
using std_srvs::srv::Trigger;

class Driver : public rclcpp_lifecycle::LifecycleNode
{
public:
  explicit Driver(const rclcpp::NodeOptions & options)
  : LifecycleNode("arm_driver", options)
  {
    declare_parameter("force", 1.0);
    // Never published on: with it DDS itself tells within a second when this process is gone.
    rclcpp::QoS alive(1);
    alive.liveliness(rclcpp::LivelinessPolicy::Automatic);
    alive.liveliness_lease_duration(std::chrono::milliseconds(250));
    alive_ = rclcpp::create_publisher<std_msgs::msg::Empty>(*this, "~/alive", alive);
  }

  CallbackReturn on_configure(const rclcpp_lifecycle::State &) override
  {
    force_ = get_parameter("force").as_double();
    return force_ > 0.0 ? CallbackReturn::SUCCESS : CallbackReturn::FAILURE;
  }

  CallbackReturn on_activate(const rclcpp_lifecycle::State & state) override
  {
    grip_ = create_service<Trigger>(
      "~/grip", [this](const Trigger::Request::SharedPtr, Trigger::Response::SharedPtr response) {
        RCLCPP_INFO(get_logger(), "gripping with %g N", force_);
        response->success = true;
      });
    return LifecycleNode::on_activate(state);
  }

  CallbackReturn on_deactivate(const rclcpp_lifecycle::State & state) override
  {
    grip_.reset();
    return LifecycleNode::on_deactivate(state);
  }

  // Without it a hook that throws ends the node for good.
  CallbackReturn on_error(const rclcpp_lifecycle::State &) override
  {
    grip_.reset();
    return CallbackReturn::SUCCESS;
  }

private:
  double force_ = 1.0;
  rclcpp::Publisher<std_msgs::msg::Empty>::SharedPtr alive_;
  rclcpp::Service<Trigger>::SharedPtr grip_;
};

}  // namespace arm

RCLCPP_COMPONENTS_REGISTER_NODE(arm::Driver)
