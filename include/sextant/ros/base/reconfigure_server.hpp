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

/// A dynamic_reconfigure server that rejects invalid values. dynamic_reconfigure's own server silently clips
/// values to their range and starts with the defaults of the .cfg file. This one starts with the parameters
/// that the node has read; a rejected call fails, changes nothing and is reported in the log and in
/// diagnostics. The service runs in the callback queue of the node handle.
template <typename Config>
class ReconfigureServer {
 public:
  /// Applies all values or throws the reason; level: bitwise or of the levels of the changed parameters.
  using Apply = std::function<void(const Config& config, uint32_t level)>;

  /// @param config current values; @param trouble must outlive the server
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
        throw std::invalid_argument("a parameter is unknown or has the wrong type");
      apply_(wanted, config_.__level__(wanted));
    } catch (const std::exception& error) {
      trouble_.refused("reconfiguration", std::string("parameters not changed: ") + error.what());
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
