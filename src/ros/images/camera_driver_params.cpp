// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#include "sextant/ros/images/camera_driver_params.hpp"

#include <algorithm>
#include <cctype>
#include <stdexcept>

namespace sextant {

void CameraDriverParams::validate() const {
  source.validate();
  player.validate();
  const auto in_name = [](unsigned char letter) { return std::isalnum(letter) || letter == '_'; };
  if (camera_name.empty() || !std::all_of(camera_name.begin(), camera_name.end(), in_name))
    throw std::invalid_argument("camera_name is '" + camera_name + "', it must be of letters, digits and _");
  if (frame_id.empty())
    throw std::invalid_argument("frame_id is empty: images need the frame of their camera");
}

CameraDriverParams CameraDriverParams::fromRos(const ros::NodeHandle& private_node) {
  CameraDriverParams params;
  ParamReader reader(private_node);
  reader.readWord("source", params.source.source);
  reader.read("encoding", params.source.encoding);
  reader.read("width", params.source.width);
  reader.read("height", params.source.height);
  reader.read("rate", params.source.rate);
  reader.read("fourcc", params.source.fourcc);
  reader.read("preload", params.source.preload);
  params.player.rate = params.source.rate;
  reader.read("loop", params.player.loop);
  reader.read("frames", params.player.frames);
  reader.read("wait_for_subscriber", params.player.wait_for_subscriber);
  reader.read("camera_name", params.camera_name);
  reader.read("camera_info_url", params.camera_info_url);
  reader.read("frame_id", params.frame_id);
  reader.rejectUnknown();
  reader.validate(params);
  return params;
}

}  // namespace sextant
