// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#include <diagnostic_updater/diagnostic_updater.h>
#include <geometry_msgs/PoseWithCovarianceStamped.h>
#include <nav_msgs/Odometry.h>
#include <nodelet/nodelet.h>
#include <tf2_ros/buffer.h>
#include <tf2_ros/transform_listener.h>

#include <boost/make_shared.hpp>
#include <functional>
#include <memory>
#include <optional>
#include <pluginlib/class_list_macros.hpp>

#include "sextant/MarkerMapEntries.h"
#include "sextant/fusion/landmark_slam_node_params.hpp"
#include "sextant/ros/base/param_reader.hpp"
#include "sextant/ros/base/rate_limit.hpp"
#include "sextant/ros/base/stage_clock.hpp"
#include "sextant/ros/base/start_in_queue.hpp"
#include "sextant/ros/base/trouble_log.hpp"
#include "sextant/ros/geometry/map_transform.hpp"
#include "sextant/ros/geometry/transform_queue.hpp"
#include "sextant/ros/landmarks/landmark_conversions.hpp"
#include "sextant/ros/landmarks/landmark_services.hpp"
#include "sextant/ros/landmarks/landmark_session.hpp"
#include "sextant/ros/landmarks/landmark_slam_report.hpp"
#include "sextant/ros/landmarks/landmark_visualization.hpp"
#include "sextant/ros/markers/marker_conversions.hpp"

namespace sextant {

/// Locates the base by odometry and landmarks, and maps the landmarks.
class LandmarkSlamNodelet : public nodelet::Nodelet {
  static constexpr double kJumpBack = 1.0;      // seconds; less is a message out of order
  static constexpr double kPictureRate = 10.0;  // Hz, for rviz

  void onInit() override {
    trouble_ = std::make_unique<TroubleLog>(getName());
    report_ = std::make_unique<LandmarkSlamReport>(*trouble_);
    try {
      params_ = readParams<LandmarkSlamNodeParams>(getPrivateNodeHandle());
      session_ = std::make_unique<LandmarkSession>(params_);
      if (const auto why = session_->whyEmpty(); !why.empty())
        NODELET_WARN("%s: %s", getName().c_str(), why.c_str());
    } catch (const std::exception& error) {
      NODELET_FATAL("%s: %s", getName().c_str(), error.what());
      throw;
    }
    waiting_ = std::make_unique<TransformQueue>(tf_, params_.transform_timeout);
    start_timer_ = startInQueue(getNodeHandle(), [this] { advertise(), subscribe(); });
  }

  void advertise() {
    // In this nodelet's queue: a thread of the listener's own wakes up a hundred times a second, and the
    // queue of several threads does not live as long as the nodelet, which a callback may keep.
    tf_listener_ = std::make_unique<tf2_ros::TransformListener>(tf_, getNodeHandle(), false);
    transform_ = std::make_unique<MapTransform>(tf_);
    ros::NodeHandle& node = getNodeHandle();
    filtered_pub_ = node.advertise<nav_msgs::Odometry>("odometry/filtered", 10);
    pose_pub_ = node.advertise<geometry_msgs::PoseWithCovarianceStamped>("pose", 10);
    picture_pub_ = node.advertise<visualization_msgs::MarkerArray>("landmark_map", 1, true);
    entries_pub_ = node.advertise<LandmarkMapEntries>("landmark_map/entries", 1, true);
    diagnostics_ = std::make_unique<diagnostic_updater::Updater>(node, getPrivateNodeHandle(), getName());
    diagnostics_->setHardwareID("none");
    diagnostics_->add("slam", this, &LandmarkSlamNodelet::diagnose);
    diagnostics_timer_ = node.createWallTimer(ros::WallDuration(1.0), [this](const ros::WallTimerEvent&) {
      publishPicture(), diagnostics_->force_update();
    });
    retry_timer_ = node.createWallTimer(
        ros::WallDuration(0.002), [this](const ros::WallTimerEvent&) { work(); }, false, false);
    services_ = offerLandmarkServices(getPrivateNodeHandle(), *session_, *trouble_, [this] { publishMap(); });
    publishMap();
  }

  void subscribe() {
    ros::NodeHandle& node = getNodeHandle();
    const auto fast = ros::TransportHints().tcpNoDelay();
    odom_sub_ = node.subscribe("odom", 100, &LandmarkSlamNodelet::onOdometry, this, fast);
    landmarks_sub_ = node.subscribe("landmarks", 20, &LandmarkSlamNodelet::onLandmarks, this, fast);
    pose_sub_ = node.subscribe("initialpose", 1, &LandmarkSlamNodelet::onInitialPose, this);
    for (size_t i = 0; i < params_.cameras.size(); ++i)
      marker_subs_.push_back(node.subscribe<MarkerArray>(
          params_.cameras[i], 20, [this, i](const MarkerArrayConstPtr& msg) { onMarkers(i, msg); }, {},
          fast));
    if (!params_.cameras.empty() && params_.marker_map_file.empty())
      map_sub_ = node.subscribe("marker_map/entries", 1, &LandmarkSlamNodelet::onMarkerMap, this);
  }

  void onMarkerMap(const MarkerMapEntriesConstPtr& msg) {
    if (markers_ && markers_->markers == msg->markers) return;  // told again: what was learnt since stays
    try {
      session_->takeMarkers(fromMsg(*msg));
      markers_ = msg, publishMap();
    } catch (const std::exception& error) {
      trouble_->report("map", "the map on " + map_sub_.getTopic() + " is not used: " + error.what());
    }
  }

  void onInitialPose(const geometry_msgs::PoseWithCovarianceStampedConstPtr& msg) {
    try {
      const std::string& frame = msg->header.frame_id;
      if (frame != session_->frame())
        throw std::invalid_argument("its frame is '" + frame + "', needed is '" + session_->frame() + "'");
      session_->setPose(planarFromMsg(msg->pose));
    } catch (const std::exception& error) {
      trouble_->refused("initialpose", pose_sub_.getTopic() + " is not used: " + error.what());
    }
  }

  // ---- odometry

  void onOdometry(const nav_msgs::OdometryConstPtr& msg) {
    report_->heardOdometry();
    try {
      takeOdometry(*msg);
    } catch (const std::exception& error) {
      trouble_->report("odometry", odom_sub_.getTopic() + " is not used: " + error.what());
      return;
    }
    odometry_ = msg;
    tellApplied();
    work();
    publishOdometry();
  }

  void takeOdometry(const nav_msgs::Odometry& msg) {
    requireHeader(msg);
    const Pose2 T_odom_base = planarFromMsg(msg.pose.pose);
    if (odometry_ && (odometry_->header.stamp - msg.header.stamp).toSec() > kJumpBack) beginAnew();
    const int leaps = session_->timeline().leaps();
    if (!session_->timeline().odometry(msg.header.stamp.toSec(), T_odom_base))
      throw std::invalid_argument("its stamp is not later than the last");
    if (session_->timeline().leaps() > leaps)
      trouble_->report("leap of odometry", odom_sub_.getTopic() + " leapt: the robot may be anywhere");
  }

  void requireHeader(const nav_msgs::Odometry& msg) const {
    if (msg.header.stamp.isZero()) throw std::invalid_argument("its stamp is zero");
    if (params_.odom_frame.empty() && msg.header.frame_id.empty())
      throw std::invalid_argument("it names no frame_id: set ~odom_frame");
    if (params_.base_frame.empty() && msg.child_frame_id.empty())
      throw std::invalid_argument("it names no child_frame_id: set ~base_frame");
  }

  /// A bag plays again: as long as tf has the later transforms it refuses the earlier ones.
  void beginAnew() {
    trouble_->report("clock",
                     "odometry's stamps jumped back: odometry and sightings are forgotten, the map is not");
    session_->restart();
    waiting_->clear();
    odometry_.reset();
    seen_ = ros::Time();
    transform_->reset();
    tf_.clear();
  }

  // ---- sightings

  void onLandmarks(const LandmarkSightingsConstPtr& msg) {
    look(msg->header, landmarks_sub_.getTopic(), [msg](const Pose& T) { return fromMsg(*msg, T); });
  }

  void onMarkers(size_t camera, const MarkerArrayConstPtr& msg) {
    const std::string topic = marker_subs_[camera].getTopic();
    for (const Marker& marker : msg->markers)
      if (!(marker.size > 0))
        trouble_->report("marker without a size", "marker " + std::to_string(marker.id) + " on " + topic +
                                                      " is left out: tell its detector ~marker_size(s)");
    look(msg->header, topic, [this, msg](const Pose& T) { return fromMsg(*msg, T, params_.markers); });
  }

  /// @param sightings in the robot frame, by T_base_frame
  void look(const std_msgs::Header& header, const std::string& topic,
            const std::function<std::vector<LabelledSighting>(const Pose&)>& sightings) {
    report_->heardSightings();
    waiting_->add(header, [this, topic, sightings, stamp = header.stamp](const Pose& T_base_frame) {
      try {
        clock_.start();
        const Arrival arrival =
            session_->timeline().see(stamp.toSec(), sightings(T_base_frame), viewOf(T_base_frame));
        clock_.finish("sightings");
        const double ahead = odometry_ ? (stamp - odometry_->header.stamp).toSec() : 0.0;
        report_->sightings(topic, arrival, ahead + params_.timeline.clock_offset, params_.timeline.lag);
        tellApplied();
      } catch (const std::exception& error) {
        trouble_->report("sightings", topic + " is not used: " + error.what());
      }
    });
    work();
  }

  void work() {
    waiting_->work(baseFrame(), [this](const std::string& why_not) {
      if (odometry_) trouble_->report("transform", why_not);  // without, base_frame may not be known
    });
    waiting_->empty() ? retry_timer_.stop() : retry_timer_.start();
  }

  /// Of sightings that came into the estimate now.
  void tellApplied() {
    const auto& applied = session_->timeline().applied();
    if (applied.empty() || !odometry_) return;
    for (const auto& [stamp, report] : applied) {
      seen_ = std::max(seen_, ros::Time(stamp));
      report_->applied(report, ros::Time(stamp), odometry_->header.stamp);
    }
    publishPose();
    publishMap();
  }

  // ---- what is told

  /// Empty: not known before the first odometry.
  std::string baseFrame() const {
    return odometry_ && params_.base_frame.empty() ? odometry_->child_frame_id : params_.base_frame;
  }
  std::string odomFrame() const {
    return params_.odom_frame.empty() ? odometry_->header.frame_id : params_.odom_frame;
  }

  /// Where it is known.
  std::optional<LandmarkTimeline::Now> now() const {
    return session_->slam().isLost() ? std::nullopt : session_->timeline().now();
  }

  void publishPose() {
    const auto now = this->now();
    if (!now) return;
    auto msg = boost::make_shared<geometry_msgs::PoseWithCovarianceStamped>();
    msg->header.stamp = odometry_->header.stamp;
    msg->header.frame_id = session_->frame();
    msg->pose = toPoseWithCovarianceMsg(now->T_map_base, now->covariance);
    pose_pub_.publish(msg);
  }

  void publishOdometry() {
    const auto now = this->now();
    if (!now) return;
    auto msg = boost::make_shared<nav_msgs::Odometry>(*odometry_);
    msg->header.frame_id = session_->frame();
    msg->child_frame_id = baseFrame();
    msg->pose = toPoseWithCovarianceMsg(now->T_map_base, now->covariance);
    filtered_pub_.publish(msg);
    if (params_.tf_output == "map_to_odom") send(odomFrame(), now->T_map_odom);
    if (params_.tf_output == "map_to_base") send(baseFrame(), now->T_map_base);
  }

  void send(const std::string& child, const Pose2& T_map_child) {
    const std::string why_not =
        transform_->send(session_->frame(), child, odometry_->header.stamp, toPose(T_map_child));
    if (!why_not.empty()) trouble_->report("tf", "tf_output " + params_.tf_output + ": " + why_not);
  }

  void publishMap() {
    auto msg = boost::make_shared<LandmarkMapEntries>(toMsg(session_->slam()));
    msg->header.stamp = seen_;
    msg->header.frame_id = session_->frame();
    entries_pub_.publish(msg);
    if (pictures_.passes(RateLimit::Clock::now(), kPictureRate)) publishPicture();
  }

  void publishPicture() {
    if (picture_pub_.getNumSubscribers() > 0)
      picture_pub_.publish(picture_.update(session_->slam(), session_->frame(), seen_));
  }

  void diagnose(diagnostic_updater::DiagnosticStatusWrapper& status) {
    std::string sightings = landmarks_sub_.getTopic();
    for (const ros::Subscriber& markers : marker_subs_) sightings += " or " + markers.getTopic();
    report_->fill(status, session_->slam(), session_->timeline().waiting(), odom_sub_.getTopic(), sightings);
    clock_.fill(status);
  }

  LandmarkSlamNodeParams params_;
  std::unique_ptr<LandmarkSession> session_;
  nav_msgs::OdometryConstPtr odometry_;  // the last
  MarkerMapEntriesConstPtr markers_;     // that are used
  ros::Time seen_;                       // stamp of the newest sightings
  LandmarkVisualization picture_;
  RateLimit pictures_;
  std::unique_ptr<TroubleLog> trouble_;
  std::unique_ptr<LandmarkSlamReport> report_;
  StageClock clock_;
  tf2_ros::Buffer tf_;
  std::unique_ptr<tf2_ros::TransformListener> tf_listener_;
  std::unique_ptr<TransformQueue> waiting_;  // sightings
  std::unique_ptr<MapTransform> transform_;
  std::unique_ptr<diagnostic_updater::Updater> diagnostics_;
  ros::WallTimer start_timer_, diagnostics_timer_, retry_timer_;
  ros::Publisher filtered_pub_, pose_pub_, picture_pub_, entries_pub_;
  ros::Subscriber odom_sub_, landmarks_sub_, pose_sub_, map_sub_;
  std::vector<ros::Subscriber> marker_subs_;
  std::vector<ros::ServiceServer> services_;
};

}  // namespace sextant

PLUGINLIB_EXPORT_CLASS(sextant::LandmarkSlamNodelet, nodelet::Nodelet)
