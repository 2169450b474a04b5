// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#include "sextant/images/camera_driver_node_params.hpp"

#include <algorithm>
#include <cctype>
#include <limits>
#include <stdexcept>

namespace sextant {
namespace {

constexpr int kMaxSide = 16384;  // pixels

void requireCameraName(const Param& param) {
  const auto in_name = [](unsigned char letter) { return std::isalnum(letter) || letter == '_'; };
  const std::string& name = *std::get<std::string*>(param.value);
  if (name.empty() || !std::all_of(name.begin(), name.end(), in_name))
    throw std::invalid_argument("camera_name is '" + name + "', it must consist of letters, digits and _");
}

void requireAutomatic(const Param& param) {
  for (const std::string& name : *std::get<std::vector<std::string>*>(param.value))
    if (name != "exposure" && name != "focus" && name != "white_balance")
      throw std::invalid_argument("automatic contains '" + name +
                                  "', allowed are exposure, focus, white_balance");
}

void requireFourcc(const Param& param) {
  const std::string& letters = *std::get<std::string*>(param.value);
  if (!letters.empty() && letters.size() != 4)
    throw std::invalid_argument("fourcc is '" + letters + "', it must be empty or four letters such as MJPG");
}

}  // namespace

ParamList CameraControlParams::fields() {
  return {
      {"exposure", &exposure, Range::closed(-1, 10), "s",
       "exposure time of a device, without its automatic control; negative: unchanged"},
      {"gain", &gain, Range::closed(-1, 1e6), "", "gain of a device in its own unit; negative: unchanged"},
      {"focus", &focus, Range::closed(-1, 1e6), "",
       "focus of a device in its own unit, without autofocus; often 0 is infinity; negative: unchanged"},
      {"white_balance", &white_balance, Range::closed(-1, 20000), "K",
       "colour temperature of a device's white balance, without its automatic control; negative: unchanged"},
      {"automatic", &automatic, Allowed("exposure, focus, white_balance", requireAutomatic), "",
       "controls that the device sets by itself; other controls without a value are unchanged"},
  };
}

ParamList ImageSourceParams::fields() {
  const Range side = Range::closed(0, kMaxSide);
  const ParamList own = {
      {"source", &source, notEmpty(), "",
       "device (`0`, `/dev/video0`, `/dev/v4l/by-id/...`), video file, image, or folder of images, played in "
       "the order of their names",
       true},
      {"encoding", &encoding, oneOf({"mono8", "bgr8"}), "", "encoding of the published images"},
      {"width", &width, side, "px",
       "image width; requested from a device; a file with another width is refused; 0: the source's own"},
      {"height", &height, side, "px",
       "image height; requested from a device; a file with another height is refused; 0: the source's own"},
      {"rate", &rate, Range::closed(0, 1000), "Hz",
       "maximum rate of a device, also requested from it, or playback rate of a file or folder; 0: the rate "
       "of the device or video, 10 Hz for a folder"},
      {"fourcc", &fourcc, Allowed("four letters or empty", requireFourcc), "",
       "pixel format requested from a device; empty: the device's own"},
      {"preload", &preload, Allowed("false for a device", nullptr), "",
       "decode a whole file or folder before the first image is published"},
  };
  return joined({own, controls.fields()});
}

ParamList ImageFeedParams::fields() {
  return {
      {"loop", &loop, Allowed(), "", "restart a file after its end"},
      {"frames", &frames, Allowed(Range::closed(0, std::numeric_limits<int>::max()), "≥ 0"), "",
       "number of images to publish before stopping; 0: no limit"},
      {"wait_for_subscriber", &wait_for_subscriber, Allowed(), "",
       "start a file only when `image_raw` has a subscriber; a device does not wait"},
  };
}

ParamList CameraDriverNodeParams::fields() {
  const ParamList own = {
      {"camera_name", &camera_name, Allowed("letters, digits and _", requireCameraName), "",
       "name of the camera in the calibration file"},
      {"camera_info_url", &camera_info_url, Allowed("path, `file://`, `package://`", nullptr), "",
       "calibration file, a path or URL; empty: `~/.ros/camera_info/CAMERA_NAME.yaml`, where the calibration "
       "tool saves it"},
      {"frame_id", &frame_id, notEmpty(), "", "optical frame of the images"},
  };
  return joined({source.fields(), feed.fields(), own});
}

}  // namespace sextant
