// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#include "sextant/images/camera_driver_node_params.hpp"

#include <algorithm>
#include <cctype>
#include <limits>
#include <stdexcept>

namespace sextant {
namespace {

constexpr int kLongestSide = 16384;  // pixels

void requireLetters(const Param& param) {
  const auto in_name = [](unsigned char letter) { return std::isalnum(letter) || letter == '_'; };
  const std::string& name = *std::get<std::string*>(param.value);
  if (name.empty() || !std::all_of(name.begin(), name.end(), in_name))
    throw std::invalid_argument("camera_name is '" + name + "', it must be of letters, digits and _");
}

void requireFour(const Param& param) {
  const std::string& letters = *std::get<std::string*>(param.value);
  if (!letters.empty() && letters.size() != 4)
    throw std::invalid_argument("fourcc is '" + letters + "', it must be empty or four letters such as MJPG");
}

}  // namespace

ParamList ImageSourceParams::fields() {
  const Range side = Range::closed(0, kLongestSide);
  return {
      {"source", &source, notEmpty(), "",
       "device (`0`, `/dev/video0`), video file, image, or folder of images (in the order of their names)",
       true},
      {"encoding", &encoding, oneOf({"mono8", "bgr8"}), "", "of the images"},
      {"width", &width, side, "px", "a device is asked for it, a file must have it; 0: as it comes"},
      {"height", &height, side, "px", "as `width`"},
      {"rate", &rate, Range::closed(0, 1000), "Hz",
       "images a second at most, and what a device is asked for; 0: a device's own, a video's own, 10 of a "
       "folder"},
      {"fourcc", &fourcc, Allowed("four letters or empty", requireFour), "",
       "pixel format that a device is asked for; empty: as it comes"},
      {"preload", &preload, Allowed("false for a device", nullptr), "",
       "decode a whole file or folder before its first image"},
  };
}

ParamList ImagePlayerParams::fields() {
  return {
      {"loop", &loop, Allowed(), "", "begin a file anew after its end"},
      {"frames", &frames, Allowed(Range::closed(0, std::numeric_limits<int>::max()), "≥ 0"), "",
       "stop after so many images; 0: never"},
      {"wait_for_subscriber", &wait_for_subscriber, Allowed(), "",
       "a file begins when the first subscriber comes; a device does not wait"},
  };
}

ParamList CameraDriverNodeParams::fields() {
  const ParamList own = {
      {"camera_name", &camera_name, Allowed("letters, digits and _", requireLetters), "",
       "as in the calibration file"},
      {"camera_info_url", &camera_info_url, Allowed("path, `file://`, `package://`", nullptr), "",
       "calibration; empty: `~/.ros/camera_info/<camera_name>.yaml`, where the calibration tool saves it"},
      {"frame_id", &frame_id, notEmpty(), "", "of the images"},
  };
  return joined({source.fields(), player.fields(), own});
}

}  // namespace sextant
