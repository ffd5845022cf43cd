// The node Whenever of btlang for BehaviorTree.CPP 4.10: condition, reaction, work.
//
//   CMakeLists.txt   find_package(behaviortree_cpp REQUIRED)
//                    target_link_libraries(my_robot behaviortree_cpp::behaviortree_cpp)  # without ROS 2: BT::behaviortree_cpp
//   once             factory.registerNodeType<btlang::Whenever>("Whenever");
//
// Each time the condition becomes true (true at the start counts too) the work is halted, the reaction is ticked until it
// completes, and then the work goes on. The node ends with the status of the work, or fails where the reaction fails. The
// condition must have been false before it counts again, which it never does with the port once="true"; one that is
// RUNNING is neither true nor false.
//
// BehaviorTree.CPP cannot suspend a node: work that was halted starts anew. Where it must keep its place, make it a
// SequenceWithMemory. A node of the work whose effect must last during the reaction is a Suspendable: KeepOut and KeepIn
// are (keep_zones.hpp).

#pragma once

#include <string>

#include <behaviortree_cpp/behavior_tree.h>
#include <behaviortree_cpp/bt_factory.h>
#include <behaviortree_cpp/control_node.h>

namespace btlang
{
// A node whose effect lasts while a Whenever interrupts it. The Whenever calls `suspend` before it halts the node, and
// `resume` after the reaction. Nested ones may each call `suspend`: the effect ends with the last `resume`, unless the node
// runs.
class Suspendable
{
public:
  virtual ~Suspendable() = default;
  virtual void suspend() = 0;
  virtual void resume() = 0;
};

class Whenever : public BT::ControlNode
{
public:
  Whenever(const std::string& name, const BT::NodeConfig& config) : BT::ControlNode(name, config)
  {}

  static BT::PortsList providedPorts()
  {
    return { BT::InputPort<bool>("once", false, "whether it reacts only the first time") };
  }

  void halt() override
  {
    armed_ = true;
    fired_ = false;
    endReaction();
    BT::ControlNode::halt();
  }

private:
  BT::NodeStatus tick() override
  {
    if(children_nodes_.size() != 3)
    {
      throw BT::LogicError("Whenever has three children: condition, reaction, work");
    }
    setStatus(BT::NodeStatus::RUNNING);

    const BT::NodeStatus asked = children_nodes_[0]->executeTick();
    if(asked != BT::NodeStatus::RUNNING)
    {
      haltChild(0);
    }
    if(asked != BT::NodeStatus::SUCCESS)
    {
      armed_ = armed_ || (!fired_ && asked != BT::NodeStatus::RUNNING);
    }
    else if(armed_ && !reacting_)
    {
      armed_ = false;
      fired_ = getInput<bool>("once").value_or(false);
      reacting_ = true;
      callInWork(&Suspendable::suspend);
      haltChild(2);
    }

    if(reacting_)
    {
      const BT::NodeStatus reaction = children_nodes_[1]->executeTick();
      if(reaction == BT::NodeStatus::RUNNING)
      {
        return reaction;
      }
      endReaction();
      haltChild(1);
      if(reaction == BT::NodeStatus::FAILURE)
      {
        return ended(reaction);
      }
    }

    const BT::NodeStatus work = children_nodes_[2]->executeTick();
    return work == BT::NodeStatus::RUNNING ? work : ended(work);
  }

  void endReaction()
  {
    if(reacting_)
    {
      reacting_ = false;
      callInWork(&Suspendable::resume);
    }
  }

  void callInWork(void (Suspendable::*call)())
  {
    BT::applyRecursiveVisitor(children_nodes_[2], [call](BT::TreeNode* node) {
      if(auto* suspendable = dynamic_cast<Suspendable*>(node))
      {
        (suspendable->*call)();
      }
    });
  }

  BT::NodeStatus ended(BT::NodeStatus status)
  {
    armed_ = true;
    fired_ = false;
    resetChildren();
    return status;
  }

  bool armed_ = true;      // the condition has been false since it last counted
  bool fired_ = false;     // it has reacted, and may not again
  bool reacting_ = false;  // the reaction is under way
};
}  // namespace btlang
