// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "sextant/base/params.hpp"

namespace sextant {

/// Manual values of a camera's controls; negative: unchanged.
struct CameraControlParams {
  double exposure = -1.0;
  double gain = -1.0;
  double focus = -1.0;
  double white_balance = -1.0;
  std::vector<std::string> automatic;

  ParamList fields();
};

/// A device, a file or a folder, and how it is opened.
struct ImageSourceParams {
  std::string source = "0";
  std::string encoding = "bgr8";
  int width = 0;
  int height = 0;
  double rate = 0.0;
  std::string fourcc = "MJPG";
  bool preload = false;
  CameraControlParams controls;  ///< of a device

  ParamList fields();
};

/// How the images of a source are published.
struct ImageFeedParams {
  double rate = 0.0;  ///< Hz; 0: the source's own
  bool loop = false;
  int frames = 0;
  bool wait_for_subscriber = true;

  ParamList fields();  ///< without the rate, which is a parameter of the source
};

/// Parameters of the nodelet sextant/CameraDriver.
struct CameraDriverNodeParams {
  ImageSourceParams source;
  ImageFeedParams feed;  ///< how they are published
  std::string camera_name = "camera";
  std::string camera_info_url;
  std::string frame_id = "camera_optical_frame";

  ParamList fields();
};

}  // namespace sextant
