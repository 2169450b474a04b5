// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <sensor_msgs/CompressedImage.h>
#include <sensor_msgs/Image.h>

#include <opencv2/core/mat.hpp>
#include <string>

namespace sextant {

/// The grey image of a message. For mono8 and 8UC1 it is the message's own memory: keep the message while it
/// is used.
/// @throws std::invalid_argument that says what is wrong: size, step, length of the data, or an encoding that
/// holds no picture (depth, float) or is unknown
cv::Mat greyFromMsg(const sensor_msgs::ImageConstPtr& msg);

/// @throws std::invalid_argument for data that OpenCV cannot decode
cv::Mat greyFromMsg(const sensor_msgs::CompressedImage& msg);

/// A colour picture as a message, with this header.
sensor_msgs::ImagePtr toImageMsg(const cv::Mat& bgr, const std_msgs::Header& header);
/// As JPEG, quality in [1, 100].
sensor_msgs::CompressedImagePtr toJpegMsg(const cv::Mat& bgr, const std_msgs::Header& header, int quality);

}  // namespace sextant
