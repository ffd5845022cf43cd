#include <behaviortree_cpp/bt_factory.h>
#include "amr_nodes/battery.hpp"
#include "amr_nodes/fetch_order.hpp"
enum class Signal { OFF = 0, GREEN = 1, YELLOW = 2, RED_LIGHT = 3 };
BT_REGISTER_NODES(factory)
{
  factory.registerNodeType<amr::FetchOrder>("FetchOrder");
  factory.registerNodeType<amr::ReportOrder>("ReportOrder");
  factory.registerNodeType<amr::LiftFork>("LiftFork");
  factory.registerNodeType<amr::BatteryAbove>("BatteryAbove");
  factory.registerNodeType<amr::ReadBattery>("ReadBattery");
  factory.registerNodeType<amr::PathClear>("PathClear");
  factory.registerNodeType<amr::DockAt>("DockAt");
  factory.registerNodeType<amr::Blink>("Blink");
  factory.registerScriptingEnums<Signal>();
}
