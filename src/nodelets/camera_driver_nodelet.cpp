// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#include <camera_info_manager/camera_info_manager.h>
#include <diagnostic_updater/diagnostic_updater.h>
#include <image_transport/camera_common.h>
#include <image_transport/image_transport.h>
#include <nodelet/nodelet.h>
#include <sensor_msgs/Image.h>

#include <boost/make_shared.hpp>
#include <memory>
#include <pluginlib/class_list_macros.hpp>

#include "sextant/images/camera_driver_node_params.hpp"
#include "sextant/ros/base/param_reader.hpp"
#include "sextant/ros/base/trouble_log.hpp"
#include "sextant/ros/images/driver_calibration.hpp"
#include "sextant/ros/images/image_feed.hpp"

namespace sextant {

/// Publishes the images of a camera, a video file or a folder, each with its CameraInfo and stamped with the
/// time at which it was grabbed.
class CameraDriverNodelet : public nodelet::Nodelet {
  void onInit() override {
    trouble_ = std::make_unique<TroubleLog>(getName());
    std::unique_ptr<ImageSource> source;
    std::string calibration_url;
    try {
      params_ = readParams<CameraDriverNodeParams>(getPrivateNodeHandle());
      params_.feed.rate = params_.source.rate;
      calibration_url = calibrationUrl(params_.camera_info_url);
      source = makeImageSource(params_.source);
    } catch (const std::exception& error) {
      NODELET_FATAL("%s: %s", getName().c_str(), error.what());
      throw;
    }
    advertise(calibration_url);
    feed_ = std::make_unique<ImageFeed>(
        std::move(source), params_.feed,
        ImageFeed::Outlet{
            [this] { return image_pub_.getNumSubscribers() > 0; },
            [this] { return image_pub_.getNumSubscribers() > 0 || info_pub_.getNumSubscribers() > 0; },
            [this](const cv::Mat& frame, const ros::Time& stamp) { publish(frame, stamp); }},
        *trouble_);
    startDiagnostics();
  }

  void advertise(const std::string& calibration_url) {
    ros::NodeHandle& node = getNodeHandle();
    const std::string topic = node.resolveName("image_raw");
    // Clients expect set_camera_info in the namespace of the image topic.
    const ros::NodeHandle beside(node, ros::names::parentNamespace(topic));
    calibration_ = std::make_unique<camera_info_manager::CameraInfoManager>(beside, params_.camera_name,
                                                                            calibration_url);
    // Two publishers, since playback of a file starts with a subscriber of the images: a CameraPublisher also
    // counts the subscribers of camera_info.
    image_pub_ = image_transport::ImageTransport(node).advertise("image_raw", 1);
    info_pub_ = node.advertise<sensor_msgs::CameraInfo>(image_transport::getCameraInfoTopic(topic), 1);
  }

  void startDiagnostics() {
    ros::NodeHandle& node = getNodeHandle();
    diagnostics_ = std::make_unique<diagnostic_updater::Updater>(node, getPrivateNodeHandle(), getName());
    diagnostics_->setHardwareID(params_.source.source);
    diagnostics_->add("camera", this, &CameraDriverNodelet::diagnose);
    diagnostics_timer_ = node.createWallTimer(
        ros::WallDuration(1.0), [this](const ros::WallTimerEvent&) { diagnostics_->force_update(); });
  }

  // In the feed's thread. A new message for every image, because subscribers in this process may keep it.
  void publish(const cv::Mat& frame, const ros::Time& stamp) {
    auto image = boost::make_shared<sensor_msgs::Image>();
    image->header.stamp = stamp;
    image->header.frame_id = params_.frame_id;
    image->encoding = params_.source.encoding;
    image->width = frame.cols;
    image->height = frame.rows;
    image->step = frame.cols * frame.elemSize();
    image->data.reserve(image->step * image->height);  // resize() would fill it with zeros first
    for (int row = 0; row < frame.rows; ++row)
      image->data.insert(image->data.end(), frame.ptr(row), frame.ptr(row) + image->step);
    info_pub_.publish(infoOf(*image));
    image_pub_.publish(sensor_msgs::ImageConstPtr(image));
  }

  sensor_msgs::CameraInfoPtr infoOf(const sensor_msgs::Image& image) {
    CheckedCalibration checked = calibrationFor(calibration_->getCameraInfo(), image.width, image.height);
    if (!checked.trouble.empty()) trouble_->report("calibration", checked.trouble);
    checked.info.header = image.header;
    return boost::make_shared<sensor_msgs::CameraInfo>(checked.info);
  }

  void diagnose(diagnostic_updater::DiagnosticStatusWrapper& status) {
    trouble_->fill(status);
    const ImageFeed::Counts counts = feed_->counts();
    const ros::SteadyTime now = ros::SteadyTime::now();
    if (counts.finished)
      status.summary(diagnostic_msgs::DiagnosticStatus::OK, "finished");
    else if (counts.opened == 0 && status.level == diagnostic_msgs::DiagnosticStatus::OK)
      status.message = "waiting for a subscriber";
    const std::string refused = feed_->refusedSettings();
    if (!refused.empty()) status.mergeSummary(diagnostic_msgs::DiagnosticStatus::WARN, refused);
    status.add("source", params_.source.source);
    status.addf("rate", "%.1f Hz", (counts.published - published_) / (now - diagnosed_).toSec());
    status.add("published", counts.published);
    status.add("not decoded", counts.skipped);
    status.add("late", counts.late);
    status.add("opened", counts.opened);
    published_ = counts.published;
    diagnosed_ = now;
  }

  CameraDriverNodeParams params_;
  std::unique_ptr<TroubleLog> trouble_;
  std::unique_ptr<camera_info_manager::CameraInfoManager> calibration_;
  image_transport::Publisher image_pub_;
  ros::Publisher info_pub_;
  unsigned long published_ = 0;  // at the last diagnostics
  ros::SteadyTime diagnosed_ = ros::SteadyTime::now();
  // Last, because their threads use the members above.
  std::unique_ptr<ImageFeed> feed_;
  std::unique_ptr<diagnostic_updater::Updater> diagnostics_;
  ros::WallTimer diagnostics_timer_;
};

}  // namespace sextant

PLUGINLIB_EXPORT_CLASS(sextant::CameraDriverNodelet, nodelet::Nodelet)
