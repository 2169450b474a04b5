// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ros/node_handle.h>
#include <std_srvs/Trigger.h>

#include <functional>
#include <string>
#include <vector>

#include "sextant/LandmarkMapFile.h"
#include "sextant/ros/base/trouble_log.hpp"
#include "sextant/ros/landmarks/landmark_session.hpp"

namespace sextant {

/// save_map, load_map, reset and relocalize of a session.
class LandmarkServices {
 public:
  /// @param changed called after each that went well
  LandmarkServices(ros::NodeHandle private_node, LandmarkSession& session, TroubleLog& trouble,
                   std::function<void()> changed);

 private:
  bool onSave(LandmarkMapFile::Request& request, LandmarkMapFile::Response& response);
  bool onLoad(LandmarkMapFile::Request& request, LandmarkMapFile::Response& response);
  bool onReset(std_srvs::Trigger::Request&, std_srvs::Trigger::Response& response);
  bool onRelocalize(std_srvs::Trigger::Request&, std_srvs::Trigger::Response& response);
  template <typename Response>
  bool answer(const std::string& service, Response& response, const std::function<std::string()>& work);
  std::string landmarks() const;

  LandmarkSession& session_;
  TroubleLog& trouble_;
  std::function<void()> changed_;
  std::vector<ros::ServiceServer> servers_;
};

}  // namespace sextant
