// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#include "sextant/ros/base/registration_check.hpp"

#include <ros/ros.h>

#include <chrono>

namespace sextant {
namespace {

constexpr std::chrono::seconds kPeriod(3);  // between two looks at the master
constexpr int kLooks = 3;                   // successive looks without the node after which it ends
const std::string kKeeper = "registration_keeper";

bool isForgottenNow() {
  XmlRpc::XmlRpcValue arguments, result, state;
  arguments[0] = ros::this_node::getName();
  return ros::master::execute("getSystemState", arguments, result, state, false) &&
         isForgotten(state, ros::this_node::getName());
}

}  // namespace

bool isForgotten(XmlRpc::XmlRpcValue system_state, const std::string& name) {
  bool has_keeper = false;
  for (int kind = 0; kind < system_state.size(); ++kind)
    for (int topic = 0; topic < system_state[kind].size(); ++topic) {
      XmlRpc::XmlRpcValue& nodes = system_state[kind][topic][1];
      for (int i = 0; i < nodes.size(); ++i) {
        const std::string node = nodes[i];
        if (node == name) return false;
        has_keeper = has_keeper || node.compare(node.rfind('/') + 1, kKeeper.size(), kKeeper) == 0;
      }
    }
  return has_keeper;
}

RegistrationCheck::RegistrationCheck() : thread_(&RegistrationCheck::run, this) {}

RegistrationCheck::~RegistrationCheck() {
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    is_ended_ = true;
  }
  ended_.notify_all();
  thread_.join();
}

void RegistrationCheck::run() {
  std::unique_lock<std::mutex> lock(mutex_);
  for (int missed = 0; missed < kLooks;) {
    if (ended_.wait_for(lock, kPeriod, [this] { return is_ended_; })) return;
    missed = isForgottenNow() ? missed + 1 : 0;
  }
  ROS_FATAL("%s is not registered at the master: ends, to be restarted by roslaunch",
            ros::this_node::getName().c_str());
  ros::requestShutdown();
}

}  // namespace sextant
