// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "sextant/base/params.hpp"

namespace sextant {

struct ImageSourceParams {
  std::string source = "0";
  std::string encoding = "bgr8";
  int width = 0;
  int height = 0;
  double rate = 0.0;
  std::string fourcc = "MJPG";
  bool preload = false;

  ParamList fields();
};

struct ImagePlayerParams {
  double rate = 0.0;  ///< that of the source
  bool loop = false;
  int frames = 0;
  bool wait_for_subscriber = true;

  ParamList fields();  ///< all but the rate
};

/// Parameters of the nodelet sextant/CameraDriver.
struct CameraDriverNodeParams {
  ImageSourceParams source;
  ImagePlayerParams player;
  std::string camera_name = "camera";
  std::string camera_info_url;
  std::string frame_id = "camera_optical_frame";

  ParamList fields();
};

}  // namespace sextant
