// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dynamic_reconfigure/Config.h>
#include <dynamic_reconfigure/ConfigDescription.h>
#include <dynamic_reconfigure/Reconfigure.h>
#include <ros/node_handle.h>

#include <functional>
#include <stdexcept>
#include <string>

#include "sextant/ros/base/trouble_log.hpp"

namespace sextant {

/// The server side of dynamic_reconfigure that refuses: dynamic_reconfigure's own moves a value that is out
/// of range to the nearest one and tells nobody, and begins with the .cfg's defaults. Here the parameters
/// that the node has read stay; a refused call fails, changes nothing and is told in the log and in
/// diagnostics. Its service runs in the node handle's queue.
template <typename Config>
class ReconfigureServer {
 public:
  /// Takes all values or throws the reason; level: the levels of those that changed.
  using Apply = std::function<void(const Config& config, uint32_t level)>;

  /// @param config what the node runs with; @param trouble must outlive this
  ReconfigureServer(const ros::NodeHandle& private_node, const Config& config, Apply apply,
                    TroubleLog& trouble)
      : node_(private_node), config_(config), apply_(std::move(apply)), trouble_(trouble) {
    descriptions_ =
        node_.advertise<dynamic_reconfigure::ConfigDescription>("parameter_descriptions", 1, true);
    descriptions_.publish(Config::__getDescriptionMessage__());
    updates_ = node_.advertise<dynamic_reconfigure::Config>("parameter_updates", 1, true);
    publish();
    service_ = node_.advertiseService("set_parameters", &ReconfigureServer::onSet, this);
  }

 private:
  bool onSet(dynamic_reconfigure::Reconfigure::Request& request,
             dynamic_reconfigure::Reconfigure::Response& response) {
    Config wanted = config_;
    try {
      if (!wanted.__fromMessage__(request.config))
        throw std::invalid_argument("a parameter is unknown or of another type");
      apply_(wanted, config_.__level__(wanted));
    } catch (const std::exception& error) {
      trouble_.refused("reconfiguration", std::string("parameters stay as they were: ") + error.what());
      return false;
    }
    config_ = wanted;
    config_.__toServer__(node_);
    publish();
    config_.__toMessage__(response.config);
    return true;
  }

  void publish() {
    dynamic_reconfigure::Config msg;
    config_.__toMessage__(msg);
    updates_.publish(msg);
  }

  ros::NodeHandle node_;
  Config config_;
  Apply apply_;
  TroubleLog& trouble_;
  ros::Publisher descriptions_, updates_;
  ros::ServiceServer service_;
};

}  // namespace sextant
