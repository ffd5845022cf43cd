// The nodes KeepOut and KeepIn of btlang for BehaviorTree.CPP 4.10: the robot keeps out of zones, or stays in them,
// while the child runs.
//
//   CMakeLists.txt   find_package(behaviortree_cpp REQUIRED)
//                    target_link_libraries(my_robot behaviortree_cpp::behaviortree_cpp)  # without ROS 2: BT::behaviortree_cpp
//   once             class MyZones : public btlang::Zones { ... };  // closes and opens zones: `hold` and `release`
//                    btlang::registerKeepZones(factory, std::make_shared<MyZones>());
//
// <KeepOut zones="stairs; wet floor"> closes the zones at its first tick and opens them when its child ends, when it is
// halted, and when it is destroyed. They are closed for the whole robot, so also for what runs in parallel. With <KeepIn
// zones="hall; lab"> the robot stays in the hall and the lab. If the robot doesn't know a zone, the node fails without
// ticking its child. A missing or empty port throws BT::RuntimeError.
//
// Nodes that hold at the same time add up: a zone opens when the last KeepOut that names it ends. If several factories
// make trees for one robot, give them the same MyZones.
//
// Whenever (whenever.hpp) halts its work while its reaction runs. Zones of that work stay closed during the reaction, and
// open before the work starts over. If an exception leaves the tick of the child, the zones stay closed until the tree is
// halted.

#pragma once

#include <cctype>
#include <map>
#include <memory>
#include <mutex>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include <behaviortree_cpp/bt_factory.h>
#include <behaviortree_cpp/decorator_node.h>

#include "whenever.hpp"

namespace btlang
{
// The zones of one robot, for you to derive from. It counts the nodes that hold, so for the same names calls of `hold` and
// `release` alternate.
class Zones
{
public:
  virtual ~Zones() = default;

  // For the nodes: makes these zones hold until `end` is called with the same arguments. Returns false, and changes
  // nothing, if the robot doesn't know one of them.
  bool begin(const std::vector<std::string>& names, bool keeps_in)
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    Restrictions begun;
    try
    {
      for(const auto& [key, own_names] : restrictions(names, keeps_in))
      {
        auto held = held_.find(key);
        if(held == held_.end())
        {
          if(!hold(own_names, keeps_in))
          {
            endAll(begun);
            return false;
          }
          held = held_.emplace(key, Held{ own_names, 0 }).first;
        }
        ++held->second.count;
        begun.emplace(key, own_names);
      }
    }
    catch(...)
    {
      endAll(begun);
      throw;
    }
    return true;
  }

  // For the nodes: takes back one call of `begin`.
  void end(const std::vector<std::string>& names, bool keeps_in) noexcept
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    endAll(restrictions(names, keeps_in));
  }

protected:
  // From now on the robot keeps out of the zone `names[0]`, the only one, or with `keeps_in` stays in the zones `names`: it
  // must be in one of them. Zones of several calls hold at the same time. Returns false if it doesn't know one of them.
  virtual bool hold(const std::vector<std::string>& names, bool keeps_in) = 0;

  // What `hold` was called for with these names no longer holds.
  virtual void release(const std::vector<std::string>& names, bool keeps_in) noexcept = 0;

private:
  using Key = std::pair<bool, std::set<std::string>>;  // keeps_in, and the names in small letters
  using Restrictions = std::map<Key, std::vector<std::string>>;

  struct Held
  {
    std::vector<std::string> names;
    int count;
  };

  // Each zone to keep out of counts by itself, but zones to stay in count together: one of them is enough.
  static Restrictions restrictions(const std::vector<std::string>& names, bool keeps_in)
  {
    Restrictions found;
    Key all{ keeps_in, {} };
    for(const std::string& name : names)
    {
      std::string small = name;
      for(char& letter : small)
      {
        letter = static_cast<char>(std::tolower(static_cast<unsigned char>(letter)));
      }
      all.second.insert(small);
      if(!keeps_in)
      {
        found[Key{ false, { small } }] = { name };
      }
    }
    if(keeps_in)
    {
      found[all] = names;
    }
    return found;
  }

  void endAll(const Restrictions& ended) noexcept
  {
    for(const auto& [key, names] : ended)
    {
      const auto held = held_.find(key);
      if(held != held_.end() && --held->second.count == 0)
      {
        release(held->second.names, key.first);
        held_.erase(held);
      }
    }
  }

  std::mutex mutex_;
  std::map<Key, Held> held_;
};

// What KeepOut and KeepIn have in common.
class KeepZones : public BT::DecoratorNode, public Suspendable
{
public:
  KeepZones(const std::string& name, const BT::NodeConfig& config, std::shared_ptr<Zones> zones, bool keeps_in)
    : BT::DecoratorNode(name, config), zones_(std::move(zones)), keeps_in_(keeps_in)
  {
    if(!zones_)
    {
      throw BT::LogicError("KeepOut and KeepIn need the zones of a robot");
    }
  }

  ~KeepZones() override
  {
    end();
  }

  static BT::PortsList providedPorts()
  {
    return { BT::InputPort<std::string>("zones", "names of zones between semicolons") };
  }

  void halt() override
  {
    BT::DecoratorNode::halt();
    if(suspensions_ == 0)
    {
      end();
    }
  }

  void suspend() override
  {
    ++suspensions_;
  }

  void resume() override
  {
    --suspensions_;
    if(suspensions_ == 0 && status() != BT::NodeStatus::RUNNING)
    {
      end();
    }
  }

private:
  BT::NodeStatus tick() override
  {
    if(names_.empty())
    {
      const std::vector<std::string> names = zoneNames();
      if(!zones_->begin(names, keeps_in_))
      {
        return BT::NodeStatus::FAILURE;
      }
      names_ = names;
    }
    setStatus(BT::NodeStatus::RUNNING);

    const BT::NodeStatus status = child_node_->executeTick();
    if(status != BT::NodeStatus::RUNNING)
    {
      end();
    }
    return status;
  }

  std::vector<std::string> zoneNames() const
  {
    const auto text = getInput<std::string>("zones");
    std::vector<std::string> names;
    std::string name;
    for(const char letter : text.value_or("") + ";")
    {
      if(letter != ';' && letter != ',')
      {
        name += letter;
        continue;
      }
      const auto first = name.find_first_not_of(" \t\r\n");
      if(first != std::string::npos)
      {
        names.push_back(name.substr(first, name.find_last_not_of(" \t\r\n") + 1 - first));
      }
      name.clear();
    }
    if(names.empty())
    {
      throw BT::RuntimeError("zones must be names of zones such as: stairs; wet floor");
    }
    return names;
  }

  void end() noexcept
  {
    if(!names_.empty())
    {
      zones_->end(names_, keeps_in_);
      names_.clear();
    }
  }

  std::shared_ptr<Zones> zones_;
  bool keeps_in_;
  std::vector<std::string> names_;  // of the zones, while they hold
  int suspensions_ = 0;             // how many Whenever nodes have interrupted the work that it belongs to
};

class KeepOut : public KeepZones
{
public:
  KeepOut(const std::string& name, const BT::NodeConfig& config, std::shared_ptr<Zones> zones)
    : KeepZones(name, config, std::move(zones), false)
  {}
};

class KeepIn : public KeepZones
{
public:
  KeepIn(const std::string& name, const BT::NodeConfig& config, std::shared_ptr<Zones> zones)
    : KeepZones(name, config, std::move(zones), true)
  {}
};

inline void registerKeepZones(BT::BehaviorTreeFactory& factory, const std::shared_ptr<Zones>& zones)
{
  factory.registerNodeType<KeepOut>("KeepOut", zones);
  factory.registerNodeType<KeepIn>("KeepIn", zones);
}
}  // namespace btlang
