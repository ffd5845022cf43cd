// Plays trees with the nodes of docs/cpp. Each line of the input is a case with three parts between tabs:
//
//   <root ...>    the XML of the tree
//   A=rrs B=RS    its leaves; each returns the letters of its word in turn, over and over
//   tt!           what to do: `!` halts the tree, `-` destroys its nodes without a halt, any other character ticks it
//
// A line of the output is its result, also with tabs: the letter of each tick, the calls of the leaves, and after each
// step and at the end, when the tree is gone, the zones that hold. Letters are those of docs/engine.md; `x` is an
// exception. A word in capitals is an action with `start`, `tick` and `halt`. The robot doesn't know the zone "nowhere".

#include <algorithm>
#include <cctype>
#include <iostream>
#include <memory>
#include <set>
#include <sstream>
#include <stdexcept>
#include <string>
#include <vector>

#include <behaviortree_cpp/bt_factory.h>

#include "keep_zones.hpp"
#include "wait_for_time.hpp"
#include "whenever.hpp"

using Log = std::vector<std::string>;

std::string joined(const Log& words)
{
  std::string text;
  for(const std::string& word : words)
  {
    text += (text.empty() ? "" : " ") + word;
  }
  return text;
}

struct Script
{
  std::string word;
  size_t next = 0;

  BT::NodeStatus status()
  {
    switch(std::tolower(word[next++ % word.size()]))
    {
      case 'r':
        return BT::NodeStatus::RUNNING;
      case 's':
        return BT::NodeStatus::SUCCESS;
      case 'f':
        return BT::NodeStatus::FAILURE;
      case 'k':
        return BT::NodeStatus::SKIPPED;
      default:
        throw std::runtime_error("as its script says");
    }
  }
};

class Leaf : public BT::ActionNodeBase
{
public:
  Leaf(const std::string& name, const BT::NodeConfig& config, std::shared_ptr<Script> script, std::shared_ptr<Log> log)
    : BT::ActionNodeBase(name, config), script_(std::move(script)), log_(std::move(log))
  {}

  static BT::PortsList providedPorts()
  {
    return {};
  }

  void halt() override
  {
    if(status() == BT::NodeStatus::RUNNING && isAction())
    {
      log_->push_back(registrationName() + ".halt");
    }
    resetStatus();
  }

private:
  BT::NodeStatus tick() override
  {
    const std::string step = status() == BT::NodeStatus::RUNNING ? ".tick" : ".start";
    log_->push_back(registrationName() + (isAction() ? step : ""));
    return script_->status();
  }

  bool isAction() const
  {
    return std::isupper(script_->word[0]) != 0;
  }

  std::shared_ptr<Script> script_;
  std::shared_ptr<Log> log_;
};

class TestZones : public btlang::Zones
{
public:
  std::string text() const
  {
    return joined({ held_.begin(), held_.end() });
  }

private:
  bool hold(const std::vector<std::string>& names, bool keeps_in) override
  {
    if(std::find(names.begin(), names.end(), "nowhere") != names.end())
    {
      return false;
    }
    if(!held_.insert(entry(names, keeps_in)).second)
    {
      throw std::logic_error("it holds already");
    }
    return true;
  }

  void release(const std::vector<std::string>& names, bool keeps_in) noexcept override
  {
    if(held_.erase(entry(names, keeps_in)) != 1)
    {
      std::cerr << "it doesn't hold" << std::endl;
      std::terminate();
    }
  }

  static std::string entry(std::vector<std::string> names, bool keeps_in)
  {
    std::sort(names.begin(), names.end());
    std::string text = keeps_in ? "in" : "out";
    for(const std::string& name : names)
    {
      text += ":" + name;
    }
    return text;
  }

  std::set<std::string> held_;
};

std::string played(const std::string& xml, const std::string& leaves, const std::string& steps)
{
  const auto log = std::make_shared<Log>();
  const auto zones = std::make_shared<TestZones>();
  BT::BehaviorTreeFactory factory;
  factory.registerNodeType<btlang::Whenever>("Whenever");
  factory.registerNodeType<btlang::WaitForTime>("WaitForTime");
  btlang::registerKeepZones(factory, zones);
  std::istringstream words(leaves);
  for(std::string leaf; words >> leaf;)
  {
    const size_t equals = leaf.find('=');
    factory.registerNodeType<Leaf>(leaf.substr(0, equals), std::make_shared<Script>(Script{ leaf.substr(equals + 1) }), log);
  }

  std::string happened;
  std::string calls;
  std::string held;
  {
    BT::Tree tree = factory.createTreeFromText(xml);
    for(const char step : steps)
    {
      if(step == '!')
      {
        tree.haltTree();
        happened += '!';
      }
      else if(step == '-')
      {
        tree.subtrees.clear();
        happened += '-';
      }
      else
      {
        try
        {
          happened += "_rsfk"[static_cast<int>(tree.tickExactlyOnce())];
        }
        catch(const std::exception&)
        {
          happened += 'x';
        }
      }
      held += zones->text() + "|";
    }
    calls = joined(*log);
  }
  return happened + "\t" + calls + "\t" + held + zones->text();
}

int main()
{
  for(std::string line; std::getline(std::cin, line);)
  {
    const size_t first = line.find('\t');
    const size_t second = line.find('\t', first + 1);
    try
    {
      std::cout << played(line.substr(0, first), line.substr(first + 1, second - first - 1), line.substr(second + 1));
    }
    catch(const std::exception& problem)
    {
      std::cout << "error\t" << problem.what() << "\t";
    }
    std::cout << std::endl;
  }
}
