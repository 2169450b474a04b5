// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#include "sextant/ros/landmarks/landmark_services.hpp"

#include <std_srvs/Trigger.h>

#include <exception>
#include <string>

#include "sextant/LandmarkMapFile.h"

namespace sextant {
namespace {

std::string countOf(const LandmarkSession& session) {
  return std::to_string(session.slam().labels().size()) + " landmarks";
}

/// @param work returns the message of the response
template <typename Service, typename Work>
ros::ServiceServer offer(ros::NodeHandle& node, const std::string& name, TroubleLog& trouble,
                         const std::function<void()>& changed, const Work& work) {
  using Request = typename Service::Request;
  using Response = typename Service::Response;
  const boost::function<bool(Request&, Response&)> callback = [&trouble, name, changed, work](
                                                                  Request& request, Response& response) {
    try {
      response.message = work(request);
      response.success = true;
      changed();
    } catch (const std::exception& error) {
      response.success = false;
      response.message = error.what();
      trouble.refused(name, name + ": " + error.what());
    }
    return true;
  };
  return node.advertiseService(name, callback);
}

}  // namespace

std::vector<ros::ServiceServer> advertiseLandmarkServices(ros::NodeHandle private_node,
                                                          LandmarkSession& session, TroubleLog& trouble,
                                                          const std::function<void()>& changed) {
  const auto save = [&session](const LandmarkMapFile::Request& request) {
    const std::string path = session.save(request.file);
    return countOf(session) + " written to " + path;
  };
  const auto load = [&session](const LandmarkMapFile::Request& request) {
    const std::string path = session.load(request.file);
    return countOf(session) + " read from " + path;
  };
  const auto reset = [&session](const std_srvs::Trigger::Request&) {
    session.reset();
    return "reset to " + countOf(session);
  };
  const auto relocalize = [&session](const std_srvs::Trigger::Request&) {
    session.relocalize();
    return "lost until the robot is relocalized with " + countOf(session);
  };
  return {offer<LandmarkMapFile>(private_node, "save_map", trouble, changed, save),
          offer<LandmarkMapFile>(private_node, "load_map", trouble, changed, load),
          offer<std_srvs::Trigger>(private_node, "reset", trouble, changed, reset),
          offer<std_srvs::Trigger>(private_node, "relocalize", trouble, changed, relocalize)};
}

}  // namespace sextant
