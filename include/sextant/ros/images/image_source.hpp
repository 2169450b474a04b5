// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>
#include <opencv2/core/mat.hpp>
#include <string>

#include "sextant/images/camera_driver_node_params.hpp"

namespace sextant {

/// Pictures one after another: of a camera, a video file or a folder. For one thread at a time.
class ImageSource {
 public:
  virtual ~ImageSource() = default;

  /// Begins at the first picture, or opens the device anew.
  /// @throws std::runtime_error that names the source and says what to do
  virtual void open() = 0;
  /// Waits for the next picture but does not decode it. False at the end, or when the device is gone.
  virtual bool grab() = 0;
  /// The picture of the last grab(), CV_8UC1 (mono8) or CV_8UC3 (bgr8); it may share the source's memory
  /// until the next grab().
  /// @throws std::runtime_error that names what cannot be decoded
  virtual cv::Mat retrieve() = 0;
  /// A device: it sets the pace, and may come back after it was gone.
  virtual bool isLive() const = 0;
  /// Pictures a second as they were recorded; 0 for a device.
  virtual double recordedRate() const = 0;
};

/// What the source names: anything in /dev and a bare number is a device, the rest is looked up on the disk.
/// A device is not opened yet: it may be plugged in later.
/// @throws std::invalid_argument or std::runtime_error with the path and what to do where there is nothing to
/// play: no such file, no image in the folder, nothing that can be decoded, another size than asked for
std::unique_ptr<ImageSource> makeImageSource(const ImageSourceParams& params);

}  // namespace sextant
