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
#include "sextant/fusion/landmark_session.hpp"
#include "sextant/fusion/landmark_slam_node_params.hpp"
#include "sextant/ros/base/param_reader.hpp"
#include "sextant/ros/base/rate_limit.hpp"
#include "sextant/ros/base/stage_clock.hpp"
#include "sextant/ros/base/stamp_jump.hpp"
#include "sextant/ros/base/start_in_queue.hpp"
#include "sextant/ros/base/subscription_lock.hpp"
#include "sextant/ros/base/trouble_log.hpp"
#include "sextant/ros/geometry/map_transform.hpp"
#include "sextant/ros/geometry/pose_conversions.hpp"
#include "sextant/ros/geometry/transform_queue.hpp"
#include "sextant/ros/landmarks/landmark_conversions.hpp"
#include "sextant/ros/landmarks/landmark_services.hpp"
#include "sextant/ros/landmarks/landmark_slam_report.hpp"
#include "sextant/ros/landmarks/landmark_visualization.hpp"
#include "sextant/ros/markers/marker_conversions.hpp"

namespace sextant {
namespace {

/// @throws std::invalid_argument after January 2038: ros::Duration cannot hold differences of such stamps
double secondsOf(const ros::Time& stamp) {
  if (stamp.sec >= static_cast<uint32_t>(std::numeric_limits<int32_t>::max()))
    throw std::invalid_argument("its stamp is after January 2038");
  return stamp.toSec();
}

}  // namespace

/// Localizes the robot by odometry and landmarks, and maps the landmarks.
class LandmarkSlamNodelet : public nodelet::Nodelet {
 public:
  ~LandmarkSlamNodelet() override {
    const SubscriptionLock lock;
    marker_subs_.clear();
    for (ros::Subscriber* sub : {&odom_sub_, &landmarks_sub_, &places_sub_, &pose_sub_, &map_sub_})
      sub->shutdown();
    tf_listener_.reset();
  }

 private:
  static constexpr double kVisualizationRate = 10.0;  // Hz

  void onInit() override {
    trouble_ = std::make_unique<TroubleLog>(getName());
    report_ = std::make_unique<LandmarkSlamReport>(*trouble_);
    try {
      params_ = readParams<LandmarkSlamNodeParams>(getPrivateNodeHandle());
      session_ = std::make_unique<LandmarkSession>(params_);
      if (const auto why = session_->emptyMapReason(); !why.empty())
        NODELET_WARN("%s: %s", getName().c_str(), why.c_str());
    } catch (const std::exception& error) {
      NODELET_FATAL("%s: %s", getName().c_str(), error.what());
      throw;
    }
    waiting_ = std::make_unique<TransformQueue>(tf_, params_.transform_timeout);
    start_ = std::make_unique<StartInQueue>(getNodeHandle(), [this] {
      const SubscriptionLock lock;
      advertise();
      subscribe();
    });
  }

  void advertise() {
    // tf messages are received in this nodelet's single-threaded queue: a thread of the listener would wake
    // up a hundred times a second, and the multi-threaded queue may be destroyed before the nodelet, because
    // a running callback may keep the nodelet alive.
    tf_listener_ = std::make_unique<tf2_ros::TransformListener>(tf_, getNodeHandle(), false);
    transform_ = std::make_unique<MapTransform>(tf_);
    ros::NodeHandle& node = getNodeHandle();
    filtered_pub_ = node.advertise<nav_msgs::Odometry>("odometry/filtered", 10);
    pose_pub_ = node.advertise<geometry_msgs::PoseWithCovarianceStamped>("pose", 10);
    if (params_.initialpose != "never")
      initialpose_pub_ = node.advertise<geometry_msgs::PoseWithCovarianceStamped>("initialpose", 1);
    visualization_pub_ = node.advertise<visualization_msgs::MarkerArray>("landmark_map", 1, true);
    entries_pub_ = node.advertise<LandmarkMapEntries>("landmark_map/entries", 1, true);
    diagnostics_ = std::make_unique<diagnostic_updater::Updater>(node, getPrivateNodeHandle(), getName());
    diagnostics_->setHardwareID("none");
    diagnostics_->add("slam", this, &LandmarkSlamNodelet::diagnose);
    diagnostics_timer_ = node.createWallTimer(ros::WallDuration(1.0), [this](const ros::WallTimerEvent&) {
      publishVisualization(), diagnostics_->force_update();
    });
    retry_timer_ = node.createWallTimer(
        ros::WallDuration(0.002), [this](const ros::WallTimerEvent&) { work(); }, false, false);
    services_ =
        advertiseLandmarkServices(getPrivateNodeHandle(), *session_, *trouble_, [this] { publishMap(); });
    publishMap();
  }

  void subscribe() {
    ros::NodeHandle& node = getNodeHandle();
    const auto fast = ros::TransportHints().tcpNoDelay();
    odom_sub_ = node.subscribe("odom", 100, &LandmarkSlamNodelet::onOdometry, this, fast);
    landmarks_sub_ = node.subscribe("landmarks", 20, &LandmarkSlamNodelet::onLandmarks, this, fast);
    if (!params_.places.empty())
      places_sub_ = node.subscribe(params_.places, 5, &LandmarkSlamNodelet::onPlaces, this, fast);
    pose_sub_ = node.subscribe("initialpose", 1, &LandmarkSlamNodelet::onInitialPose, this);
    for (size_t i = 0; i < params_.cameras.size(); ++i)
      marker_subs_.push_back(node.subscribe<MarkerArray>(
          params_.cameras[i], 20, [this, i](const MarkerArrayConstPtr& msg) { onMarkers(i, msg); }, {},
          fast));
    if (!params_.cameras.empty() && params_.marker_map_file.empty())
      map_sub_ = node.subscribe("marker_map/entries", 1, &LandmarkSlamNodelet::onMarkerMap, this);
  }

  void onMarkerMap(const MarkerMapEntriesConstPtr& msg) {
    if (markers_ && markers_->markers == msg->markers)
      return;  // latched map received again: keep the current one
    try {
      session_->setMarkerMap(fromMsg(*msg));
      markers_ = msg, publishMap();
    } catch (const std::exception& error) {
      trouble_->report("map", "the map on " + map_sub_.getTopic() + " is not used: " + error.what());
    }
  }

  void onInitialPose(const geometry_msgs::PoseWithCovarianceStampedConstPtr& msg) {
    if (initialpose_ && msg->header.stamp == initialpose_->header.stamp && msg->pose == initialpose_->pose)
      return;  // its own
    try {
      const std::string& frame = msg->header.frame_id;
      if (frame != session_->frame())
        throw std::invalid_argument("its frame is '" + frame + "', it must be '" + session_->frame() + "'");
      session_->setPose(planarFromMsg(msg->pose));
    } catch (const std::exception& error) {
      trouble_->refused("initialpose", pose_sub_.getTopic() + " is not used: " + error.what());
    }
  }

  void onPlaces(const PlaceHypothesesConstPtr& msg) {
    try {
      const auto poses = fromMsg(*msg, transformFrom(msg->frame));
      const Arrival arrival = session_->timeline().observePlaces(secondsOf(msg->header.stamp), poses);
      if (arrival == Arrival::too_late)
        throw std::invalid_argument("its image is older than ~lag: raise it, or make the places faster");
      if (msg->status == PlaceHypotheses::UNUSABLE) report_->unusableImage(msg->header.stamp);
      publishApplied();
    } catch (const std::exception& error) {
      trouble_->report("places", places_sub_.getTopic() + " is not used: " + error.what());
    }
  }

  /// T_map_frame. @throws std::invalid_argument if the frame is empty, tf2::TransformException if there is no
  /// transform
  Pose2 transformFrom(const std::string& frame) const {
    if (frame.empty())
      throw std::invalid_argument("its map has no frame: add one to the place map, see its metric header");
    if (frame == session_->frame()) return {};
    return planarFromMsg(
        toPoseMsg(fromMsg(tf_.lookupTransform(session_->frame(), frame, ros::Time(0)).transform)));
  }

  // ---- odometry

  void onOdometry(const nav_msgs::OdometryConstPtr& msg) {
    report_->odometryReceived();
    try {
      applyOdometry(*msg);
    } catch (const std::exception& error) {
      trouble_->report("odometry", odom_sub_.getTopic() + " is not used: " + error.what());
      return;
    }
    odometry_ = msg;
    publishApplied();
    work();
    publishOdometry();
  }

  void applyOdometry(const nav_msgs::Odometry& msg) {
    requireHeader(msg);
    const Pose2 T_odom_base = planarFromMsg(msg.pose.pose);
    if (odometry_ && jumpsBack(msg.header.stamp, odometry_->header.stamp)) restart();
    const int jumps = session_->timeline().jumps();
    if (!session_->timeline().odometry(secondsOf(msg.header.stamp), T_odom_base))
      throw std::invalid_argument("its stamp is not newer than that of the last message");
    if (session_->timeline().jumps() > jumps)
      trouble_->report("odometry jump",
                       odom_sub_.getTopic() + " jumped: the robot is lost until it is relocalized");
  }

  void requireHeader(const nav_msgs::Odometry& msg) const {
    if (msg.header.stamp.isZero()) throw std::invalid_argument("its stamp is zero");
    if (params_.odom_frame.empty() && msg.header.frame_id.empty())
      throw std::invalid_argument("it has no frame_id: set ~odom_frame");
    if (params_.base_frame.empty() && msg.child_frame_id.empty())
      throw std::invalid_argument("it has no child_frame_id: set ~base_frame");
  }

  /// Restarts when a bag is played again: tf rejects older transforms while it has newer ones.
  void restart() {
    trouble_->report(
        "clock",
        "the stamps of odometry jumped back: odometry and observations are dropped, the map is kept");
    session_->restart();
    report_->restarted();
    waiting_->clear();
    odometry_.reset();
    map_stamp_ = ros::Time();
    transform_->reset();
    tf_.clear();
  }

  // ---- observations

  void onLandmarks(const LandmarkObservationsConstPtr& msg) {
    addScan(msg->header, landmarks_sub_.getTopic(), Detects::all,
            [msg](const Pose& T) { return fromMsg(*msg, T); });
  }

  void onMarkers(size_t camera, const MarkerArrayConstPtr& msg) {
    const std::string topic = marker_subs_[camera].getTopic();
    for (const Marker& marker : msg->markers)
      if (!(marker.size > 0))
        trouble_->report("marker without a size", "marker " + std::to_string(marker.id) + " on " + topic +
                                                      " is skipped: set ~marker_size(s) of its detector");
    addScan(msg->header, topic, Detects::with_id,
            [this, msg](const Pose& T) { return fromMsg(*msg, T, params_.markers, session_->markerMap()); });
  }

  /// @param observations converts the message to the robot frame, given T_base_frame
  void addScan(const std_msgs::Header& header, const std::string& topic, Detects detects,
               const std::function<std::vector<LabelledObservation>(const Pose&)>& observations) {
    report_->observationsReceived();
    waiting_->add(header, [this, topic, detects, observations,
                           stamp = header.stamp](const Pose& T_base_frame) {
      try {
        clock_.start();
        const Arrival arrival = session_->timeline().observe(secondsOf(stamp), observations(T_base_frame),
                                                             planarSensorPose(T_base_frame), detects);
        clock_.finish("observations");
        const double ahead = odometry_ ? stamp.toSec() - odometry_->header.stamp.toSec() : 0.0;
        report_->observations(topic, arrival, ahead + params_.timeline.clock_offset, params_.timeline.lag);
        publishApplied();
      } catch (const std::exception& error) {
        trouble_->report("observations", topic + " is not used: " + error.what());
      }
    });
    work();
  }

  void work() {
    waiting_->process(baseFrame(), [this](const std::string& why_not) {
      if (odometry_) trouble_->report("transform", why_not);  // without odometry, base_frame may be unknown
    });
    waiting_->empty() ? retry_timer_.stop() : retry_timer_.start();
  }

  /// Publishes after scans were applied.
  void publishApplied() {
    const auto& applied = session_->timeline().applied();
    if (applied.empty() || !odometry_) return;
    for (const LandmarkTimeline::Applied& each : applied) {
      if (!each.places) map_stamp_ = std::max(map_stamp_, ros::Time(each.stamp));
      report_->applied(each, odometry_->header.stamp);
    }
    publishPose();
    publishMap();
  }

  // ---- publishing

  /// Empty before the first odometry if ~base_frame is not set.
  std::string baseFrame() const {
    return odometry_ && params_.base_frame.empty() ? odometry_->child_frame_id : params_.base_frame;
  }
  std::string odomFrame() const {
    return params_.odom_frame.empty() ? odometry_->header.frame_id : params_.odom_frame;
  }

  /// Current pose; nothing while lost.
  std::optional<LandmarkTimeline::Now> now() const {
    return session_->slam().isLost() ? std::nullopt : session_->timeline().now();
  }

  void publishPose() {
    const auto now = this->now();
    if (!now) is_initialpose_due_ = true;
    if (!now) return;
    const auto msg = boost::make_shared<geometry_msgs::PoseWithCovarianceStamped>();
    msg->header.stamp = odometry_->header.stamp;
    msg->header.frame_id = session_->frame();
    msg->pose = toPoseWithCovarianceMsg(now->T_map_base, now->covariance);
    pose_pub_.publish(msg);
    if (!is_initialpose_due_ || initialpose_pub_.getNumSubscribers() < 2) return;  // one of them is this node
    initialpose_pub_.publish(initialpose_ = msg);
    is_initialpose_due_ = false;
  }

  void publishOdometry() {
    const auto now = this->now();
    if (!now) is_initialpose_due_ = true;
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
    msg->header.stamp = map_stamp_;
    msg->header.frame_id = session_->frame();
    entries_pub_.publish(msg);
    if (visualization_rate_.passes(RateLimit::Clock::now(), kVisualizationRate)) publishVisualization();
  }

  void publishVisualization() {
    if (visualization_pub_.getNumSubscribers() > 0)
      visualization_pub_.publish(visualization_.update(session_->slam(), session_->frame(), map_stamp_));
  }

  void diagnose(diagnostic_updater::DiagnosticStatusWrapper& status) {
    std::string observations = landmarks_sub_.getTopic();
    for (const ros::Subscriber& markers : marker_subs_) observations += " or " + markers.getTopic();
    report_->fill(status, session_->timeline().hypotheses(), session_->timeline().waiting(),
                  odom_sub_.getTopic(), observations);
    clock_.fill(status);
  }

  LandmarkSlamNodeParams params_;
  std::unique_ptr<LandmarkSession> session_;
  nav_msgs::OdometryConstPtr odometry_;                           // newest
  MarkerMapEntriesConstPtr markers_;                              // marker map in use
  geometry_msgs::PoseWithCovarianceStampedConstPtr initialpose_;  // the last that was published
  bool is_initialpose_due_ = true;  // no pose was published there since the start, or since it was lost
  ros::Time map_stamp_;             // of the newest observations
  LandmarkVisualization visualization_;
  RateLimit visualization_rate_;
  std::unique_ptr<TroubleLog> trouble_;
  std::unique_ptr<LandmarkSlamReport> report_;
  StageClock clock_;
  tf2_ros::Buffer tf_;
  std::unique_ptr<tf2_ros::TransformListener> tf_listener_;
  std::unique_ptr<TransformQueue> waiting_;  // observations
  std::unique_ptr<MapTransform> transform_;
  std::unique_ptr<diagnostic_updater::Updater> diagnostics_;
  std::unique_ptr<StartInQueue> start_;
  ros::WallTimer diagnostics_timer_, retry_timer_;
  ros::Publisher filtered_pub_, pose_pub_, initialpose_pub_, visualization_pub_, entries_pub_;
  ros::Subscriber odom_sub_, landmarks_sub_, places_sub_, pose_sub_, map_sub_;
  std::vector<ros::Subscriber> marker_subs_;
  std::vector<ros::ServiceServer> services_;
};

}  // namespace sextant

PLUGINLIB_EXPORT_CLASS(sextant::LandmarkSlamNodelet, nodelet::Nodelet)
