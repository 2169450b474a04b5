// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#include <diagnostic_updater/diagnostic_updater.h>
#include <image_transport/camera_common.h>
#include <nodelet/nodelet.h>
#include <std_srvs/SetBool.h>
#include <tf2_ros/transform_broadcaster.h>

#include <boost/make_shared.hpp>
#include <memory>
#include <opencv2/core/utility.hpp>
#include <optional>
#include <pluginlib/class_list_macros.hpp>

#include "sextant/MarkerArray.h"
#include "sextant/MarkerDetectorConfig.h"
#include "sextant/detection/marker_detector_node_params.hpp"
#include "sextant/markers/marker_drawing.hpp"
#include "sextant/ros/base/param_reader.hpp"
#include "sextant/ros/base/rate_limit.hpp"
#include "sextant/ros/base/reconfigure_server.hpp"
#include "sextant/ros/base/reconfigure_values.hpp"
#include "sextant/ros/base/stage_clock.hpp"
#include "sextant/ros/base/start_in_queue.hpp"
#include "sextant/ros/base/subscription_lock.hpp"
#include "sextant/ros/base/trouble_log.hpp"
#include "sextant/ros/detection/detector_report.hpp"
#include "sextant/ros/detection/image_conversions.hpp"
#include "sextant/ros/geometry/camera_conversions.hpp"
#include "sextant/ros/markers/marker_conversions.hpp"

namespace sextant {

/// Detects printed markers in images and publishes their corners and poses in the camera frame.
class MarkerDetectorNodelet : public nodelet::Nodelet {
 public:
  ~MarkerDetectorNodelet() override { unsubscribe(); }

 private:
  void onInit() override {
    trouble_ = std::make_unique<TroubleLog>(getName());
    try {
      params_ = readParams<MarkerDetectorNodeParams>(getPrivateNodeHandle());
      detector_ = makeMarkerDetector(params_.detector);
    } catch (const std::exception& error) {
      NODELET_FATAL("%s: %s", getName().c_str(), error.what());
      throw;
    }
    enabled_ = params_.enabled;
    start_ = std::make_unique<StartInQueue>(getNodeHandle(), [this] {
      advertise();
      updateSubscription();
    });
  }

  void advertise() {
    ros::NodeHandle& node = getNodeHandle();
    const auto update = [this](const ros::SingleSubscriberPublisher&) { updateSubscription(); };
    markers_pub_ = node.advertise<MarkerArray>("markers", 1, update, update);
    debug_pub_ = node.advertise<sensor_msgs::Image>("markers/image", 1, update, update);
    jpeg_pub_ = node.advertise<sensor_msgs::CompressedImage>("markers/image/compressed", 1, update, update);
    enable_srv_ = getPrivateNodeHandle().advertiseService("enable", &MarkerDetectorNodelet::onEnable, this);
    diagnostics_ = std::make_unique<diagnostic_updater::Updater>(node, getPrivateNodeHandle(), getName());
    diagnostics_->setHardwareID("none");
    diagnostics_->add("detection", this, &MarkerDetectorNodelet::diagnose);
    reconfigure_ = std::make_unique<ReconfigureServer<MarkerDetectorConfig>>(
        getPrivateNodeHandle(), toConfig<MarkerDetectorConfig>(params_),
        [this](const MarkerDetectorConfig& config, uint32_t level) { reconfigure(config, level); },
        *trouble_);
    diagnostics_timer_ =
        node.createWallTimer(ros::WallDuration(1.0), [this](const ros::WallTimerEvent&) { everySecond(); });
  }

  // Called from the callback queue of the images, so never while one is processed. Level 1
  // (cfg/MarkerDetector.cfg): a parameter of the detector changed; it is created again and loses its tracks.
  void reconfigure(const MarkerDetectorConfig& config, uint32_t level) {
    const MarkerDetectorNodeParams changed = withConfig(params_, config);
    if (level & 1) detector_ = makeMarkerDetector(changed.detector);
    params_ = changed;
  }

  // Updates the subscription, too: for a subscriber that connected before the callback queue was active, no
  // callback is called.
  void everySecond() {
    updateSubscription();
    diagnostics_->force_update();
  }

  // Subscribes to images only while the detector is enabled and its results are used, by a subscriber or tf.
  void updateSubscription() {
    const bool needed = params_.publish_tf || markers_pub_.getNumSubscribers() > 0 ||
                        debug_pub_.getNumSubscribers() > 0 || jpeg_pub_.getNumSubscribers() > 0;
    if (!enabled_ || !needed) {
      unsubscribe();
    } else if (!image_sub_) {
      subscribe();
    }
  }

  void unsubscribe() {
    if (!image_sub_) return;
    const SubscriptionLock lock;
    image_sub_.shutdown();
    info_sub_.shutdown();
  }

  void subscribe() {
    const SubscriptionLock lock;
    ros::NodeHandle& node = getNodeHandle();
    const auto no_delay = ros::TransportHints().tcpNoDelay();
    info_sub_ = node.subscribe(infoTopic(), 1, &MarkerDetectorNodelet::onInfo, this, no_delay);
    if (params_.compressed)
      image_sub_ =
          node.subscribe("image/compressed", 1, &MarkerDetectorNodelet::onCompressed, this, no_delay);
    else
      image_sub_ = node.subscribe("image", 1, &MarkerDetectorNodelet::onImage, this, no_delay);
  }

  // camera_info beside the image topic, as image_transport expects it, unless it is remapped.
  std::string infoTopic() const {
    const std::string plain = getNodeHandle().resolveName("camera_info", false);
    const std::string resolved = getNodeHandle().resolveName("camera_info");
    if (resolved != plain) return resolved;
    return image_transport::getCameraInfoTopic(getNodeHandle().resolveName("image"));
  }

  void onInfo(const sensor_msgs::CameraInfoConstPtr& info) {
    if (info_ && sameCalibration(*info, *info_)) return;
    info_ = info;
    camera_.reset();
    try {
      camera_.emplace(fromMsg(*info),
                      params_.rectified ? CameraModel::Image::rectified : CameraModel::Image::raw);
    } catch (const std::invalid_argument& error) {
      camera_trouble_ = error.what();
    }
  }

  static bool sameCalibration(const sensor_msgs::CameraInfo& a, const sensor_msgs::CameraInfo& b) {
    return a.width == b.width && a.height == b.height && a.K == b.K && a.D == b.D && a.R == b.R &&
           a.P == b.P && a.distortion_model == b.distortion_model && a.binning_x == b.binning_x &&
           a.binning_y == b.binning_y && a.roi == b.roi;
  }

  void onImage(const sensor_msgs::ImageConstPtr& msg) {
    process(msg->header, [&] { return greyFromMsg(msg); });
  }

  void onCompressed(const sensor_msgs::CompressedImageConstPtr& msg) {
    process(msg->header, [&] { return greyFromMsg(*msg); });
  }

  template <typename Decode>
  void process(const std_msgs::Header& header, Decode decode) {
    if (!search_rate_.passes(RateLimit::Clock::now(), params_.rate)) return;
    report_.image();
    try {
      clock_.start();
      const cv::Mat image = decode();
      requireCamera(image);
      clock_.finish("image");
      const auto detections = detect(image);
      clock_.finish("detection");
      const auto markers = observeMarkers(*camera_, detections, params_.sizes, params_.corner_sigma);
      clock_.finish("marker poses");
      publish(header, markers);
      clock_.finish("publication");
      publishDebugImage(header, image, markers);
      trouble_->succeeded();
    } catch (const std::invalid_argument& error) {
      trouble_->report("image", error.what());
    } catch (const Uncalibrated& error) {
      trouble_->report("calibration", error.what());
    } catch (const std::exception& error) {
      trouble_->report("failure", error.what());
    }
  }

  // OpenCV runs even tiny loops on all cores; for searches in small windows, waking its threads takes
  // longer than the loop. Loops inside a parallel_for_ run on the calling thread: one of a single iteration
  // keeps the detection on one thread.
  std::vector<Detection> detect(const cv::Mat& image) {
    std::vector<Detection> detections;
    const auto search = [&](const cv::Range&) { detections = detector_->detect(image, &*camera_); };
    if (params_.detector.threads > 1)
      search({});
    else
      cv::parallel_for_({0, 1}, search);
    return detections;
  }

  struct Uncalibrated : std::runtime_error {
    using std::runtime_error::runtime_error;
  };

  void requireCamera(const cv::Mat& image) const {
    if (!info_)
      throw Uncalibrated("no calibration on " + info_sub_.getTopic() +
                         " yet: does the camera driver publish camera_info?");
    if (!camera_) throw Uncalibrated("on " + info_sub_.getTopic() + ": " + camera_trouble_);
    if (image.cols != camera_->width() || image.rows != camera_->height())
      throw Uncalibrated("the calibration on " + info_sub_.getTopic() + " is for " +
                         std::to_string(camera_->width()) + " x " + std::to_string(camera_->height()) +
                         " pixels, the image has " + std::to_string(image.cols) + " x " +
                         std::to_string(image.rows));
  }

  void publish(const std_msgs::Header& header, const std::vector<ObservedMarker>& markers) {
    auto msg = boost::make_shared<MarkerArray>();
    msg->header = header;
    msg->camera_info = *info_;
    msg->rectified = params_.rectified;
    for (const ObservedMarker& marker : markers)
      msg->markers.push_back(toMsg(marker.detection, marker.size, marker.poses, marker.covariance));
    markers_pub_.publish(msg);
    report_.published(markers, header.stamp, ros::Time::now());
    if (!params_.publish_tf) return;
    if (header.stamp.isZero() || header.frame_id.empty())
      throw std::invalid_argument(
          "the image's header has no stamp or no frame_id: cannot broadcast its markers");
    broadcast(header, markers);
  }

  void broadcast(const std_msgs::Header& header, const std::vector<ObservedMarker>& markers) {
    std::vector<geometry_msgs::TransformStamped> transforms;
    for (const ObservedMarker& marker : markers) {
      if (!marker.poses) continue;
      const MarkerKey& key = marker.detection.key;
      geometry_msgs::TransformStamped transform;
      transform.header = header;
      transform.child_frame_id = params_.tf_prefix + key.family + "/" + std::to_string(key.id);
      transform.transform = toTransformMsg(marker.poses->best.T_camera_marker);
      transforms.push_back(transform);
    }
    broadcaster_.sendTransform(transforms);
  }

  void publishDebugImage(const std_msgs::Header& header, const cv::Mat& image,
                         const std::vector<ObservedMarker>& markers) {
    const bool raw = debug_pub_.getNumSubscribers() > 0, jpeg = jpeg_pub_.getNumSubscribers() > 0;
    if (!(raw || jpeg) || !debug_rate_.passes(RateLimit::Clock::now(), params_.debug_rate)) return;
    const cv::Mat drawing = drawMarkers(image, *camera_, markers, params_.debug_width);
    if (raw) debug_pub_.publish(toImageMsg(drawing, header));
    clock_.finish("debug image");
    if (!jpeg) return;
    jpeg_pub_.publish(toJpegMsg(drawing, header, params_.debug_quality));
    clock_.finish("debug image as JPEG");
  }

  bool onEnable(std_srvs::SetBool::Request& request, std_srvs::SetBool::Response& response) {
    enabled_ = request.data;
    updateSubscription();
    response.success = true;
    response.message = enabled_ ? "detection is on" : "detection is off";
    return true;
  }

  void diagnose(diagnostic_updater::DiagnosticStatusWrapper& status) {
    trouble_->fill(status);
    if (!enabled_)
      status.summary(diagnostic_msgs::DiagnosticStatus::OK, "switched off");
    else if (!image_sub_)
      status.summary(diagnostic_msgs::DiagnosticStatus::OK, "no subscriber");
    else if (report_.images() == 0)
      status.summary(diagnostic_msgs::DiagnosticStatus::WARN, "no image on " + image_sub_.getTopic());
    report_.fill(status);
    clock_.fill(status);
  }

  MarkerDetectorNodeParams params_;
  std::unique_ptr<MarkerDetector> detector_;
  sensor_msgs::CameraInfoConstPtr info_;
  std::optional<CameraModel> camera_;
  std::string camera_trouble_;
  bool enabled_ = true;
  DetectorReport report_;
  RateLimit search_rate_, debug_rate_;
  std::unique_ptr<TroubleLog> trouble_;
  StageClock clock_;
  tf2_ros::TransformBroadcaster broadcaster_;
  std::unique_ptr<diagnostic_updater::Updater> diagnostics_;
  std::unique_ptr<ReconfigureServer<MarkerDetectorConfig>> reconfigure_;
  std::unique_ptr<StartInQueue> start_;
  ros::WallTimer diagnostics_timer_;
  ros::Publisher markers_pub_, debug_pub_, jpeg_pub_;
  ros::ServiceServer enable_srv_;
  ros::Subscriber image_sub_, info_sub_;
};

}  // namespace sextant

PLUGINLIB_EXPORT_CLASS(sextant::MarkerDetectorNodelet, nodelet::Nodelet)
