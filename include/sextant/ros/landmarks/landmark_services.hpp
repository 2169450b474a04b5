// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ros/node_handle.h>

#include <functional>
#include <vector>

#include "sextant/fusion/landmark_session.hpp"
#include "sextant/ros/base/trouble_log.hpp"

namespace sextant {

/// Advertises ~save_map, ~load_map, ~reset and ~relocalize. @param changed called after each successful call
std::vector<ros::ServiceServer> advertiseLandmarkServices(ros::NodeHandle private_node,
                                                          LandmarkSession& session, TroubleLog& trouble,
                                                          const std::function<void()>& changed);

}  // namespace sextant
