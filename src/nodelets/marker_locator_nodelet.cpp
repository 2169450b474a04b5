// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#include <diagnostic_updater/diagnostic_updater.h>
#include <geometry_msgs/PoseWithCovarianceStamped.h>
#include <nodelet/nodelet.h>
#include <tf2_ros/buffer.h>
#include <tf2_ros/transform_broadcaster.h>
#include <tf2_ros/transform_listener.h>

#include <boost/make_shared.hpp>
#include <deque>
#include <memory>
#include <optional>
#include <pluginlib/class_list_macros.hpp>

#include "sextant/MarkerArray.h"
#include "sextant/MarkerMapEntries.h"
#include "sextant/core/marker_locator.hpp"
#include "sextant/ros/conversions.hpp"
#include "sextant/ros/locator_visualization.hpp"
#include "sextant/ros/marker_locator_params.hpp"
#include "sextant/ros/stage_clock.hpp"
#include "sextant/ros/tf_bridge.hpp"
#include "sextant/ros/trouble_log.hpp"

namespace sextant {

/// Tells the base's pose in the map from the markers that cameras see.
class MarkerLocatorNodelet : public nodelet::Nodelet {
  static constexpr size_t kMaxPending = 30;  // images of one camera that wait for a transform
  static constexpr double kJumpBack = 1.0;   // seconds; less is an image out of order

  // Markers that may wait for a transform.
  struct Pending {
    MarkerArrayConstPtr markers;
    ros::SteadyTime deadline;
    std::string missing;  // the transform, with the reason
  };
  struct Camera {
    std::deque<Pending> pending;
    ros::Time newest;
  };

  void onInit() override {
    trouble_ = std::make_unique<TroubleLog>(getName());
    try {
      params_ = MarkerLocatorParams::fromRos(getPrivateNodeHandle());
      locator_ = std::make_unique<MarkerLocator>(params_.locator);
      if (!params_.map_file.empty()) map_ = readMarkerMap(params_.map_file, params_.text);
    } catch (const std::exception& error) {
      NODELET_FATAL("%s: %s", getName().c_str(), error.what());
      throw;
    }
    tf_listener_ = std::make_unique<tf2_ros::TransformListener>(tf_);
    advertise();
    subscribe();
  }

  void advertise() {
    ros::NodeHandle& node = getNodeHandle();
    pose_pub_ = node.advertise<geometry_msgs::PoseWithCovarianceStamped>("pose", 1);
    visualization_pub_ = node.advertise<visualization_msgs::MarkerArray>("visualization", 1);
    diagnostics_ = std::make_unique<diagnostic_updater::Updater>(node, getPrivateNodeHandle(), getName());
    diagnostics_->setHardwareID("none");
    diagnostics_->add("localization", this, &MarkerLocatorNodelet::diagnose);
    diagnostics_timer_ =
        node.createWallTimer(ros::WallDuration(1.0), [this](const ros::WallTimerEvent&) { everySecond(); });
    retry_timer_ = node.createWallTimer(
        ros::WallDuration(0.002), [this](const ros::WallTimerEvent&) { work(); }, false, false);
  }

  // A latched map that came before the nodelet's queue was open is lost: it is asked for again.
  void everySecond() {
    if (!map_) subscribeMap();
    diagnostics_->force_update();
  }

  void subscribeMap() {
    map_sub_ = getNodeHandle().subscribe("marker_map/entries", 1, &MarkerLocatorNodelet::onMap, this);
  }

  void subscribe() {
    ros::NodeHandle& node = getNodeHandle();
    subscribeMap();
    cameras_.resize(params_.cameras.size());
    for (size_t i = 0; i < params_.cameras.size(); ++i)
      marker_subs_.push_back(node.subscribe<MarkerArray>(
          params_.cameras[i], 1, [this, i](const MarkerArrayConstPtr& msg) { onMarkers(cameras_[i], msg); },
          {}, ros::TransportHints().tcpNoDelay()));
  }

  void onMap(const MarkerMapEntriesConstPtr& msg) {
    try {
      map_ = fromMsg(*msg);
      visualization_.clear();
    } catch (const std::exception& error) {
      trouble_->report("map", "the map on " + map_sub_.getTopic() + " is not used: " + error.what());
    }
  }

  void onMarkers(Camera& camera, const MarkerArrayConstPtr& msg) {
    ++images_;
    const ros::Time stamp = msg->header.stamp;
    if (!stamp.isZero() && camera.newest.toSec() - stamp.toSec() > kJumpBack) beginAnew();
    camera.newest = stamp;
    camera.pending.push_back(
        {msg, ros::SteadyTime::now() + ros::WallDuration(params_.transform_timeout), ""});
    if (camera.pending.size() > kMaxPending) giveUp(camera);
    work();
  }

  // A bag plays again: as long as tf has the later transforms it refuses the earlier ones.
  void beginAnew() {
    trouble_->report("clock", "the images' stamps jumped back: what tf knew is forgotten");
    for (Camera& camera : cameras_) camera.pending.clear();
    tf_.clear();
    visualization_.clear();
  }

  // The oldest that waits is told of and dropped.
  void giveUp(Camera& camera) {
    trouble_->report("transform", camera.pending.front().missing);
    camera.pending.pop_front();
  }

  // Locates what waits, in the order of arrival; a missing transform may still come until its deadline.
  void work() {
    bool waiting = false;
    for (Camera& camera : cameras_) {
      while (!camera.pending.empty()) {
        Pending& oldest = camera.pending.front();
        if (tryLocate(oldest))
          camera.pending.pop_front();
        else if (ros::SteadyTime::now() >= oldest.deadline)
          giveUp(camera);
        else
          break;
      }
      waiting = waiting || !camera.pending.empty();
    }
    waiting ? retry_timer_.start() : retry_timer_.stop();
  }

  // What tf knows of an image's stamp: the mount, and the odometry where it is needed.
  struct Frames {
    Pose T_base_camera = Pose::Identity();
    Pose T_odom_base = Pose::Identity();
  };

  std::optional<Frames> lookUpFrames(const std_msgs::Header& header, std::string& missing) {
    Frames frames;
    if (params_.base_frame.empty()) return frames;
    const auto mount = lookUp(tf_, params_.base_frame, header.frame_id, header.stamp);
    missing = mount.reason;
    if (!mount.T_target_source) return std::nullopt;
    frames.T_base_camera = *mount.T_target_source;
    if (params_.tf_output != "map_to_odom") return frames;
    const auto odometry = lookUp(tf_, params_.odom_frame, params_.base_frame, header.stamp);
    missing = odometry.reason;
    if (!odometry.T_target_source) return std::nullopt;
    frames.T_odom_base = *odometry.T_target_source;
    return frames;
  }

  // False: a transform is missing.
  bool tryLocate(Pending& pending) {
    const MarkerArray& msg = *pending.markers;
    if (!map_) {
      trouble_->report("map", "no marker map yet: set ~map_file, or start marker_broadcaster (" +
                                  map_sub_.getTopic() + ")");
      return true;
    }
    clock_.start();
    const auto frames = lookUpFrames(msg.header, pending.missing);
    if (!frames) return false;
    try {
      const LocatorResult result = locator_->locate(*map_, {view(msg, frames->T_base_camera)});
      clock_.finish("localization");
      report(result, msg.markers.empty());
      if (result.pose) publish(msg.header, *frames, *result.pose);
      clock_.finish("publication");
    } catch (const std::exception& error) {
      trouble_->report("markers", error.what());
    }
    return true;
  }

  static MarkerView view(const MarkerArray& msg, const Pose& T_base_camera) {
    const auto image = msg.rectified ? CameraModel::Image::rectified : CameraModel::Image::raw;
    MarkerView view{CameraModel(fromMsg(msg.camera_info), image), T_base_camera, {}};
    for (const Marker& marker : msg.markers) view.detections.push_back(fromMsg(marker));
    return view;
  }

  void report(const LocatorResult& result, bool nothing_seen) {
    for (const MarkerKey& key : result.unmapped) ++unmapped_[key];
    for (const MarkerKey& key : result.repeated)
      trouble_->report("repeated marker",
                       "marker " + std::to_string(key.id) + " (" + key.family +
                           ") is in one image more than once and is left out: hang each id once");
    if (result.pose) {
      ++poses_;
      reprojection_error_ = result.pose->reprojection_error;
      trouble_->succeeded();
      return;
    }
    ++reasons_[result.reason];
    if (nothing_seen)
      trouble_->succeeded();
    else
      trouble_->report("markers in vain", "no pose: " + result.reason);
  }

  void publish(const std_msgs::Header& header, const Frames& frames, const LocatedPose& located) {
    auto msg = boost::make_shared<geometry_msgs::PoseWithCovarianceStamped>();
    msg->header.stamp = header.stamp;
    msg->header.frame_id = map_->frame();
    msg->pose = toPoseWithCovarianceMsg(located.T_map_base, located.covariance);
    pose_pub_.publish(msg);
    broadcast(header.stamp, frames, located.T_map_base);
    if (visualization_pub_.getNumSubscribers() > 0)
      visualization_pub_.publish(
          visualization_.update(located, located.T_map_base * frames.T_base_camera, *map_, header.stamp));
  }

  void broadcast(const ros::Time& stamp, const Frames& frames, const Pose& T_map_base) {
    if (params_.tf_output == "none") return;
    const bool to_odom = params_.tf_output == "map_to_odom";
    const std::string& child = to_odom ? params_.odom_frame : params_.base_frame;
    const std::string parent = parentFrame(tf_, child);
    if (!parent.empty() && parent != map_->frame() && parent != sent_parent_) {
      trouble_->report("tf", "'" + child + "' already has the parent '" + parent + "': tf_output " +
                                 params_.tf_output + " would break the tree and is not sent");
      return;
    }
    if (stamp == last_transform_) return;  // tf warns of a stamp given twice
    last_transform_ = stamp;
    geometry_msgs::TransformStamped transform;
    transform.header.stamp = stamp;
    transform.header.frame_id = sent_parent_ = map_->frame();
    transform.child_frame_id = child;
    transform.transform = toTransformMsg(to_odom ? T_map_base * frames.T_odom_base.inverse() : T_map_base);
    broadcaster_.sendTransform(transform);
  }

  void diagnose(diagnostic_updater::DiagnosticStatusWrapper& status) {
    using diagnostic_msgs::DiagnosticStatus;
    trouble_->fill(status);
    if (!map_)
      status.summary(DiagnosticStatus::WARN, "no marker map yet");
    else if (images_ == 0)
      status.summary(DiagnosticStatus::WARN, "no markers on " + params_.cameras.front());
    status.add("images", images_);
    status.add("poses", poses_);
    status.add("reprojection error (px)", reprojection_error_);
    status.add("markers in the map", map_ ? map_->markers().size() : 0);
    for (const auto& [reason, count] : reasons_) status.add("no pose: " + reason, count);
    for (const auto& [key, count] : unmapped_)
      status.add("not in the map: " + key.family + "/" + std::to_string(key.id), count);
    clock_.fill(status);
  }

  MarkerLocatorParams params_;
  std::unique_ptr<MarkerLocator> locator_;
  std::optional<MarkerMap> map_;
  std::vector<Camera> cameras_;
  ros::Time last_transform_;
  std::string sent_parent_;  // the map's frame may change: this one is ours
  LocatorVisualization visualization_;
  unsigned long images_ = 0, poses_ = 0;
  double reprojection_error_ = 0.0;
  std::map<std::string, unsigned long> reasons_;
  std::map<MarkerKey, unsigned long> unmapped_;
  std::unique_ptr<TroubleLog> trouble_;
  StageClock clock_;
  tf2_ros::Buffer tf_;
  std::unique_ptr<tf2_ros::TransformListener> tf_listener_;
  tf2_ros::TransformBroadcaster broadcaster_;
  std::unique_ptr<diagnostic_updater::Updater> diagnostics_;
  ros::WallTimer diagnostics_timer_, retry_timer_;
  ros::Publisher pose_pub_, visualization_pub_;
  ros::Subscriber map_sub_;
  std::vector<ros::Subscriber> marker_subs_;
};

}  // namespace sextant

PLUGINLIB_EXPORT_CLASS(sextant::MarkerLocatorNodelet, nodelet::Nodelet)
