// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>
#include <opencv2/core/mat.hpp>
#include <string>
#include <vector>

#include "sextant/images/camera_driver_node_params.hpp"

namespace sextant {

/// A sequence of images from a camera, a video file or a folder. Not thread-safe.
class ImageSource {
 public:
  virtual ~ImageSource() = default;

  /// Goes to the first image, or (re)opens the device.
  /// @throws std::runtime_error with the source and the remedy
  virtual void open() = 0;
  /// Waits for the next image without decoding it. Returns false at the end, or if the device is gone.
  virtual bool grab() = 0;
  /// Decodes the image of the last grab(): CV_8UC1 (mono8) or CV_8UC3 (bgr8). The image may share memory with
  /// the source until the next grab().
  /// @throws std::runtime_error with the name of the image that cannot be decoded
  virtual cv::Mat retrieve() = 0;
  /// Settings that the device refused in the last open(), each as a text for the user.
  virtual std::vector<std::string> refusedSettings() const { return {}; }
  /// Whether the source is a device, which sets the rate itself and may be reconnected.
  virtual bool isLive() const = 0;
  /// Rate of the recording, Hz; 0 for a device.
  virtual double recordedRate() const = 0;
};

/// Creates the source that the parameter names: a path in /dev or a bare number is a device, any other path a
/// file or folder. A device is not opened yet, because it may be plugged in later.
/// @throws std::invalid_argument or std::runtime_error with the path and the remedy if there is nothing to
/// play: no such file, no image in the folder, nothing that can be decoded, an image size other than
/// requested
std::unique_ptr<ImageSource> makeImageSource(const ImageSourceParams& params);

}  // namespace sextant
