// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <sensor_msgs/CompressedImage.h>
#include <sensor_msgs/Image.h>

#include <opencv2/core/mat.hpp>
#include <string>

namespace sextant {

/// Converts a message to an 8-bit grey image. For mono8 and 8UC1 the image shares the memory of the message,
/// which must outlive it.
/// @throws std::invalid_argument with the reason: wrong size, step or data length, or an encoding that is
/// unknown or not of an intensity image (depth, float)
cv::Mat greyFromMsg(const sensor_msgs::ImageConstPtr& msg);

/// Decodes a compressed image to 8-bit grey.
/// @throws std::invalid_argument for data that OpenCV cannot decode
cv::Mat greyFromMsg(const sensor_msgs::CompressedImage& msg);

/// Converts an 8-bit BGR image to a message.
sensor_msgs::ImagePtr toImageMsg(const cv::Mat& bgr, const std_msgs::Header& header);
/// Converts an 8-bit BGR image to a JPEG message. @param quality [1, 100]
sensor_msgs::CompressedImagePtr toJpegMsg(const cv::Mat& bgr, const std_msgs::Header& header, int quality);

}  // namespace sextant
