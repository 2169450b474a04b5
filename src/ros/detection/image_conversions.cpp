// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#include "sextant/ros/detection/image_conversions.hpp"

#include <cv_bridge/cv_bridge.h>
#include <sensor_msgs/image_encodings.h>

#include <boost/make_shared.hpp>
#include <opencv2/imgcodecs.hpp>
#include <stdexcept>

#include "sextant/images/grey_image.hpp"

namespace sextant {
namespace {

namespace encodings = sensor_msgs::image_encodings;

void requireIntensity(const std::string& encoding) {
  const bool is_intensity = encodings::isMono(encoding) || encodings::isColor(encoding) ||
                            encodings::isBayer(encoding) || encoding == encodings::YUV422 ||
                            encoding == encodings::TYPE_8UC1 || encoding == encodings::TYPE_8UC3 ||
                            encoding == encodings::TYPE_8UC4;
  if (!is_intensity)
    throw std::invalid_argument("the image's encoding '" + encoding +
                                "' is not grey or colour, so it cannot show markers; publish mono8 or bgr8");
}

void requireWhole(const sensor_msgs::Image& msg) {
  if (msg.width == 0 || msg.height == 0)
    throw std::invalid_argument("the image is empty (" + std::to_string(msg.width) + " x " +
                                std::to_string(msg.height) + ")");
  const size_t pixel = encodings::numChannels(msg.encoding) * (encodings::bitDepth(msg.encoding) / 8);
  if (msg.step < msg.width * pixel)
    throw std::invalid_argument("the image's step of " + std::to_string(msg.step) +
                                " bytes is too short for " + std::to_string(msg.width) + " pixels of " +
                                msg.encoding);
  if (msg.data.size() < static_cast<size_t>(msg.step) * msg.height)
    throw std::invalid_argument("the image is cut short: " + std::to_string(msg.data.size()) + " bytes of " +
                                std::to_string(static_cast<size_t>(msg.step) * msg.height));
}

cv::Mat view(const sensor_msgs::Image& msg, int type) {
  return {static_cast<int>(msg.height), static_cast<int>(msg.width), type,
          const_cast<uint8_t*>(msg.data.data()), msg.step};
}

// cv_bridge cannot read the other byte order, and the upper eight bits suffice.
cv::Mat highBytes(const sensor_msgs::Image& msg) {
  cv::Mat grey;
  cv::extractChannel(view(msg, CV_8UC2), grey, msg.is_bigendian ? 0 : 1);
  return grey;
}

cv::Mat converted(const sensor_msgs::ImageConstPtr& msg) {
  const cv::Mat grey = cv_bridge::toCvShare(msg, encodings::MONO8)->image;
  if (grey.type() != CV_8UC1) throw std::invalid_argument("its byte order is not supported");
  return grey;
}

}  // namespace

cv::Mat greyFromMsg(const sensor_msgs::ImageConstPtr& msg) {
  requireIntensity(msg->encoding);
  requireWhole(*msg);
  if (msg->encoding == encodings::MONO8 || msg->encoding == encodings::TYPE_8UC1) return view(*msg, CV_8UC1);
  if (msg->encoding == encodings::TYPE_8UC3) return greyImage(view(*msg, CV_8UC3));
  if (msg->encoding == encodings::TYPE_8UC4) return greyImage(view(*msg, CV_8UC4));
  if (msg->encoding == encodings::MONO16) return highBytes(*msg);
  try {
    return converted(msg);
  } catch (const std::exception& error) {
    throw std::invalid_argument("the image of encoding " + msg->encoding +
                                " cannot be read: " + error.what());
  }
}

cv::Mat greyFromMsg(const sensor_msgs::CompressedImage& msg) {
  cv::Mat image;
  try {
    if (!msg.data.empty())
      image = cv::imdecode(msg.data, cv::IMREAD_GRAYSCALE | cv::IMREAD_IGNORE_ORIENTATION);
  } catch (const cv::Exception& error) {
    throw std::invalid_argument("the compressed image (" + msg.format +
                                ") cannot be decoded: " + error.what());
  }
  if (image.empty())
    throw std::invalid_argument("the compressed image (" + msg.format + ") cannot be decoded");
  return image;
}

sensor_msgs::ImagePtr toImageMsg(const cv::Mat& bgr, const std_msgs::Header& header) {
  return cv_bridge::CvImage(header, encodings::BGR8, bgr).toImageMsg();
}

sensor_msgs::CompressedImagePtr toJpegMsg(const cv::Mat& bgr, const std_msgs::Header& header, int quality) {
  auto msg = boost::make_shared<sensor_msgs::CompressedImage>();
  msg->header = header;
  msg->format = "bgr8; jpeg compressed bgr8";
  cv::imencode(".jpg", bgr, msg->data, {cv::IMWRITE_JPEG_QUALITY, quality});
  return msg;
}

}  // namespace sextant
