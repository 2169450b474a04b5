// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ros/node_handle.h>

#include <functional>
#include <vector>

#include "sextant/ros/base/trouble_log.hpp"
#include "sextant/ros/landmarks/landmark_session.hpp"

namespace sextant {

/// save_map, load_map, reset and relocalize of a session. @param changed called after each that went well
std::vector<ros::ServiceServer> offerLandmarkServices(ros::NodeHandle private_node, LandmarkSession& session,
                                                      TroubleLog& trouble,
                                                      const std::function<void()>& changed);

}  // namespace sextant
