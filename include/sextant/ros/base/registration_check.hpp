// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <xmlrpcpp/XmlRpcValue.h>

#include <condition_variable>
#include <mutex>
#include <string>
#include <thread>

namespace sextant {

/// Whether a master knows a registration_keeper, but not the node with this full name.
/// @param system_state its answer to getSystemState: publishers, subscribers and services, each with their
/// nodes
bool isForgotten(XmlRpc::XmlRpcValue system_state, const std::string& name);

/// Shuts this node down if it is not registered although a registration_keeper runs, so that roslaunch
/// restarts it: it was just starting while roscore was restarted. Checks in a thread of its own, as
/// sextant.nodes.base.registration_check does for Python nodes.
class RegistrationCheck {
 public:
  RegistrationCheck();
  ~RegistrationCheck();
  RegistrationCheck(const RegistrationCheck&) = delete;
  RegistrationCheck& operator=(const RegistrationCheck&) = delete;

 private:
  void run();

  std::mutex mutex_;
  std::condition_variable ended_;
  bool is_ended_ = false;
  std::thread thread_;
};

}  // namespace sextant
