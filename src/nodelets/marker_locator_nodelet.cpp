// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#include <diagnostic_updater/diagnostic_updater.h>
#include <geometry_msgs/PoseWithCovarianceStamped.h>
#include <nodelet/nodelet.h>
#include <tf2_ros/buffer.h>
#include <tf2_ros/transform_listener.h>

#include <boost/make_shared.hpp>
#include <deque>
#include <memory>
#include <optional>
#include <pluginlib/class_list_macros.hpp>

#include "sextant/MarkerArray.h"
#include "sextant/MarkerLocatorConfig.h"
#include "sextant/MarkerMapEntries.h"
#include "sextant/localization/marker_localization.hpp"
#include "sextant/localization/marker_locator_node_params.hpp"
#include "sextant/localization/stamp_groups.hpp"
#include "sextant/ros/base/param_reader.hpp"
#include "sextant/ros/base/reconfigure_server.hpp"
#include "sextant/ros/base/reconfigure_values.hpp"
#include "sextant/ros/base/stage_clock.hpp"
#include "sextant/ros/base/stamp_jump.hpp"
#include "sextant/ros/base/start_in_queue.hpp"
#include "sextant/ros/base/subscription_lock.hpp"
#include "sextant/ros/base/trouble_log.hpp"
#include "sextant/ros/geometry/camera_conversions.hpp"
#include "sextant/ros/geometry/map_transform.hpp"
#include "sextant/ros/geometry/transform_lookup.hpp"
#include "sextant/ros/localization/locator_report.hpp"
#include "sextant/ros/localization/locator_visualization.hpp"
#include "sextant/ros/markers/marker_conversions.hpp"

namespace sextant {

/// Publishes the pose of the base in the map, from the markers that the cameras detect.
class MarkerLocatorNodelet : public nodelet::Nodelet {
 public:
  ~MarkerLocatorNodelet() override {
    const SubscriptionLock lock;
    marker_subs_.clear();
    map_sub_.shutdown();
    tf_listener_.reset();
  }

 private:
  static constexpr size_t kMaxPending = 30;  // maximum number of instants that wait for a transform

  using Groups = StampGroups<MarkerArrayConstPtr>;

  // The markers of all cameras at one instant, which may wait for a transform.
  struct Instant {
    std::vector<Groups::Member> images;
    ros::Time stamp;  // of the newest image
    ros::SteadyTime deadline;
    std::string missing;  // the missing transform, with the reason
  };

  // The transforms of an instant.
  struct Frames {
    std::vector<Pose> T_base_camera;  // of each image, to the base at the instant's stamp
    std::optional<Pose> T_odom_base;
  };

  void onInit() override {
    trouble_ = std::make_unique<TroubleLog>(getName());
    report_ = std::make_unique<LocatorReport>(*trouble_);
    try {
      params_ = readParams<MarkerLocatorNodeParams>(getPrivateNodeHandle());
      localization_ = std::make_unique<MarkerLocalization>(params_.localization);
      if (!params_.map_file.empty()) map_ = readMarkerMap(params_.map_file, params_.text);
    } catch (const std::exception& error) {
      NODELET_FATAL("%s: %s", getName().c_str(), error.what());
      throw;
    }
    groups_ = std::make_unique<Groups>(
        StampGroupsParams{params_.cameras.size(), params_.camera_window, params_.camera_timeout});
    newest_.resize(params_.cameras.size());
    start_ = std::make_unique<StartInQueue>(getNodeHandle(), [this] {
      const SubscriptionLock lock;
      advertise();
      subscribe();
    });
  }

  void advertise() {
    // In this nodelet's single-threaded queue: a dedicated thread would wake up a hundred times a second, and
    // the multi-threaded queue may be destroyed before the nodelet, which a callback can keep alive.
    tf_listener_ = std::make_unique<tf2_ros::TransformListener>(tf_, getNodeHandle(), false);
    ros::NodeHandle& node = getNodeHandle();
    transform_ = std::make_unique<MapTransform>(tf_);
    pose_pub_ = node.advertise<geometry_msgs::PoseWithCovarianceStamped>("pose", 1);
    if (params_.initialpose != "never")
      initialpose_pub_ = node.advertise<geometry_msgs::PoseWithCovarianceStamped>("initialpose", 1);
    visualization_pub_ = node.advertise<visualization_msgs::MarkerArray>("visualization", 1);
    diagnostics_ = std::make_unique<diagnostic_updater::Updater>(node, getPrivateNodeHandle(), getName());
    diagnostics_->setHardwareID("none");
    diagnostics_->add("localization", this, &MarkerLocatorNodelet::diagnose);
    reconfigure_ = std::make_unique<ReconfigureServer<MarkerLocatorConfig>>(
        getPrivateNodeHandle(), toConfig<MarkerLocatorConfig>(params_),
        [this](const MarkerLocatorConfig& config, uint32_t) { reconfigure(config); }, *trouble_);
    diagnostics_timer_ =
        node.createWallTimer(ros::WallDuration(1.0), [this](const ros::WallTimerEvent&) { everySecond(); });
    retry_timer_ = node.createWallTimer(
        ros::WallDuration(0.002), [this](const ros::WallTimerEvent&) { processPending(); }, false, false);
    if (params_.tf_output == "map_to_odom" && params_.tf_rate > 0)
      transform_timer_ = node.createWallTimer(ros::WallDuration(1 / params_.tf_rate),
                                              [this](const ros::WallTimerEvent&) { repeatTransform(); });
  }

  // In the callback queue of the images, so between two of them.
  void reconfigure(const MarkerLocatorConfig& config) {
    const MarkerLocatorNodeParams changed = withConfig(params_, config);
    localization_->setParams(changed.localization);
    params_ = changed;
  }

  // A latched map that arrived before the callback queue was active is lost: subscribe again.
  void everySecond() {
    if (!map_) {
      const SubscriptionLock lock;
      subscribeMap();
    }
    diagnostics_->force_update();
  }

  void subscribeMap() {
    map_sub_ = getNodeHandle().subscribe("marker_map/entries", 1, &MarkerLocatorNodelet::onMap, this);
  }

  void subscribe() {
    ros::NodeHandle& node = getNodeHandle();
    subscribeMap();
    for (size_t i = 0; i < params_.cameras.size(); ++i)
      marker_subs_.push_back(node.subscribe<MarkerArray>(
          params_.cameras[i], 1, [this, i](const MarkerArrayConstPtr& msg) { onMarkers(i, msg); }, {},
          ros::TransportHints().tcpNoDelay()));
  }

  void onMap(const MarkerMapEntriesConstPtr& msg) {
    try {
      map_ = fromMsg(*msg);
      localization_->resetMap();
      visualization_.clear();
    } catch (const std::exception& error) {
      trouble_->report("map", "the map on " + map_sub_.getTopic() + " is not used: " + error.what());
    }
  }

  void onMarkers(size_t camera, const MarkerArrayConstPtr& msg) {
    report_->image();
    const ros::Time stamp = msg->header.stamp;
    if (!stamp.isZero() && jumpsBack(stamp, newest_[camera])) restart();
    newest_[camera] = stamp;
    groups_->add(camera, stamp.toSec(), ros::SteadyTime::now().toSec(), msg);
    processPending();
  }

  // A bag was restarted: tf rejects transforms that are older than those it has.
  void restart() {
    trouble_->report("clock", "the images' stamps jumped back: localization restarts");
    groups_->clear();
    pending_.clear();
    tf_.clear();
    std::fill(newest_.begin(), newest_.end(), ros::Time());  // the other cameras' stamps jump back, too
    localization_->reset();
    transform_->reset();
    visualization_.clear();
  }

  // Locates the pending instants in order of arrival; each waits for its transforms until its deadline.
  void processPending() {
    const ros::SteadyTime now = ros::SteadyTime::now();
    while (auto images = groups_->take(now.toSec()))
      pending_.push_back(instant(std::move(*images), now + ros::WallDuration(params_.transform_timeout)));
    while (!pending_.empty()) {
      const bool give_up = pending_.size() > kMaxPending || now >= pending_.front().deadline;
      if (!tryLocate(pending_.front())) {
        if (!give_up) break;
        trouble_->report("transform", pending_.front().missing);
      }
      pending_.pop_front();
    }
    pending_.empty() && groups_->empty() ? retry_timer_.stop() : retry_timer_.start();
  }

  static Instant instant(std::vector<Groups::Member> images, const ros::SteadyTime& deadline) {
    Instant instant{std::move(images), {}, deadline, ""};
    for (const auto& image : instant.images)
      instant.stamp = std::max(instant.stamp, image.item->header.stamp);
    return instant;
  }

  std::optional<Pose> lookUpOrExplain(const std::string& target, const std::string& source,
                                      const ros::Time& stamp, std::string& missing) {
    const TransformLookup found = lookUp(tf_, target, source, stamp);
    missing = found.reason;
    return found.T_target_source;
  }

  // With odometry, an image with an earlier stamp than the instant's is corrected for the motion in between.
  std::optional<Frames> lookUpFrames(Instant& instant) {
    Frames frames;
    const bool with_odometry = params_.needsOdometry();
    if (with_odometry) {
      frames.T_odom_base =
          lookUpOrExplain(params_.odom_frame, params_.base_frame, instant.stamp, instant.missing);
      if (!frames.T_odom_base) return std::nullopt;
    }
    for (const auto& image : instant.images) {
      const std_msgs::Header& header = image.item->header;
      frames.T_base_camera.push_back(Pose::Identity());
      if (params_.base_frame.empty()) continue;
      const auto mount = lookUpOrExplain(params_.base_frame, header.frame_id, header.stamp, instant.missing);
      if (!mount) return std::nullopt;
      frames.T_base_camera.back() = *mount;
      if (!with_odometry || header.stamp == instant.stamp) continue;
      const auto then =
          lookUpOrExplain(params_.odom_frame, params_.base_frame, header.stamp, instant.missing);
      if (!then) return std::nullopt;
      frames.T_base_camera.back() = frames.T_odom_base->inverse() * *then * *mount;
    }
    return frames;
  }

  // Returns whether the instant is done: false only while a transform is missing.
  bool tryLocate(Instant& instant) {
    if (!map_) {
      trouble_->report("map",
                       "no marker map yet: set ~map_file, or start marker_broadcaster, which publishes " +
                           map_sub_.getTopic());
      return true;
    }
    clock_.start();
    const auto frames = lookUpFrames(instant);
    if (!frames) return false;
    try {
      const auto stamp = instant.stamp.isZero() ? std::nullopt : std::optional(instant.stamp.toSec());
      const LocatorResult result =
          localization_->locate(*map_, views(instant, *frames), frames->T_odom_base, stamp);
      clock_.finish("localization");
      size_t detected = 0;
      for (const auto& image : instant.images) detected += image.item->markers.size();
      report_->result(result, detected);
      if (result.pose) publish(instant, *frames, *result.pose);
      clock_.finish("publication");
    } catch (const std::exception& error) {
      trouble_->report("markers", error.what());
    }
    return true;
  }

  static std::vector<MarkerView> views(const Instant& instant, const Frames& frames) {
    std::vector<MarkerView> all;
    for (size_t i = 0; i < instant.images.size(); ++i) {
      const MarkerArray& msg = *instant.images[i].item;
      const auto image = msg.rectified ? CameraModel::Image::rectified : CameraModel::Image::raw;
      MarkerView view{CameraModel(fromMsg(msg.camera_info), image), frames.T_base_camera[i], {}};
      view.camera_index = instant.images[i].camera;
      for (const Marker& marker : msg.markers) view.detections.push_back(fromMsg(marker));
      all.push_back(std::move(view));
    }
    return all;
  }

  void publish(const Instant& instant, const Frames& frames, const LocatedPose& located) {
    auto msg = boost::make_shared<geometry_msgs::PoseWithCovarianceStamped>();
    msg->header.stamp = instant.stamp;
    msg->header.frame_id = map_->frame();
    msg->pose = toPoseWithCovarianceMsg(located.T_map_base, located.covariance);
    pose_pub_.publish(msg);
    const int starts = localization_->correction().starts();
    if (starts != published_starts_ && initialpose_pub_.getNumSubscribers() > 0) {
      initialpose_pub_.publish(msg);
      published_starts_ = starts;
    }
    report_->published(instant.stamp, ros::Time::now());
    if (params_.tf_output == "map_to_base") send(instant.stamp, located.T_map_base);
    const auto T_map_odom = localization_->correction().transform();
    if (params_.tf_output == "map_to_odom" && T_map_odom) send(instant.stamp, *T_map_odom);
    if (visualization_pub_.getNumSubscribers() > 0)
      visualization_pub_.publish(visualization_.update(
          located, located.T_map_base * frames.T_base_camera.front(), *map_, instant.stamp));
  }

  void send(const ros::Time& stamp, const Pose& T_map_child) {
    const std::string why_not = transform_->send(map_->frame(), params_.childFrame(), stamp, T_map_child);
    if (!why_not.empty()) trouble_->report("tf", "tf_output " + params_.tf_output + ": " + why_not);
  }

  // Repeats map -> odom for new odometry, so that lookups in the map succeed at every stamp of the odometry.
  void repeatTransform() {
    const auto T_map_odom = localization_->correction().transform();
    if (!map_ || !T_map_odom) return;
    const ros::Time newest = newestCommonTime(tf_, params_.odom_frame, params_.base_frame);
    if (!newest.isZero()) send(newest, *T_map_odom);
  }

  void diagnose(diagnostic_updater::DiagnosticStatusWrapper& status) {
    report_->fill(status, *localization_, map_ ? &*map_ : nullptr, params_.cameras);
    clock_.fill(status);
  }

  MarkerLocatorNodeParams params_;
  std::unique_ptr<MarkerLocalization> localization_;
  std::optional<MarkerMap> map_;
  std::unique_ptr<Groups> groups_;
  std::deque<Instant> pending_;
  std::vector<ros::Time> newest_;  // newest stamp of each camera
  LocatorVisualization visualization_;
  std::unique_ptr<TroubleLog> trouble_;
  std::unique_ptr<LocatorReport> report_;
  StageClock clock_;
  tf2_ros::Buffer tf_;
  std::unique_ptr<tf2_ros::TransformListener> tf_listener_;
  std::unique_ptr<MapTransform> transform_;
  std::unique_ptr<diagnostic_updater::Updater> diagnostics_;
  std::unique_ptr<ReconfigureServer<MarkerLocatorConfig>> reconfigure_;
  std::unique_ptr<StartInQueue> start_;
  ros::WallTimer diagnostics_timer_, retry_timer_, transform_timer_;
  int published_starts_ = 0;  // of the odometry filter, whose pose was published on initialpose
  ros::Publisher pose_pub_, initialpose_pub_, visualization_pub_;
  ros::Subscriber map_sub_;
  std::vector<ros::Subscriber> marker_subs_;
};

}  // namespace sextant

PLUGINLIB_EXPORT_CLASS(sextant::MarkerLocatorNodelet, nodelet::Nodelet)
