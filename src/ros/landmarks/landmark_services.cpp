// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#include "sextant/ros/landmarks/landmark_services.hpp"

#include <exception>
#include <utility>

namespace sextant {

LandmarkServices::LandmarkServices(ros::NodeHandle private_node, LandmarkSession& session,
                                   TroubleLog& trouble, std::function<void()> changed)
    : session_(session), trouble_(trouble), changed_(std::move(changed)) {
  servers_ = {private_node.advertiseService("save_map", &LandmarkServices::onSave, this),
              private_node.advertiseService("load_map", &LandmarkServices::onLoad, this),
              private_node.advertiseService("reset", &LandmarkServices::onReset, this),
              private_node.advertiseService("relocalize", &LandmarkServices::onRelocalize, this)};
}

template <typename Response>
bool LandmarkServices::answer(const std::string& service, Response& response,
                              const std::function<std::string()>& work) {
  try {
    response.message = work();
    response.success = true;
    changed_();
  } catch (const std::exception& error) {
    response.success = false;
    response.message = error.what();
    trouble_.refused(service, service + ": " + error.what());
  }
  return true;
}

std::string LandmarkServices::landmarks() const {
  return std::to_string(session_.slam().labels().size()) + " landmarks";
}

bool LandmarkServices::onSave(LandmarkMapFile::Request& request, LandmarkMapFile::Response& response) {
  return answer("save_map", response, [&] {
    const std::string path = session_.save(request.file);
    return landmarks() + " written to " + path;
  });
}

bool LandmarkServices::onLoad(LandmarkMapFile::Request& request, LandmarkMapFile::Response& response) {
  return answer("load_map", response, [&] {
    const std::string path = session_.load(request.file);
    return landmarks() + " read from " + path;
  });
}

bool LandmarkServices::onReset(std_srvs::Trigger::Request&, std_srvs::Trigger::Response& response) {
  return answer("reset", response, [&] {
    session_.reset();
    return "begun anew with " + landmarks();
  });
}

bool LandmarkServices::onRelocalize(std_srvs::Trigger::Request&, std_srvs::Trigger::Response& response) {
  return answer("relocalize", response, [&] {
    session_.relocalize();
    return "lost until the robot finds itself among " + landmarks();
  });
}

}  // namespace sextant
