// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#include "sextant/mapping/map_maker.hpp"

#include <algorithm>
#include <set>
#include <stdexcept>
#include <utility>

#include "known_markers.hpp"
#include "map_draft.hpp"
#include "map_frame.hpp"
#include "sextant/mapping/keyframes.hpp"
#include "sextant/mapping/map_adjustment.hpp"

namespace sextant {
namespace {

constexpr int kPlainRounds = 6;  // maximum number of adjustments without robust loss
constexpr double kNoRobustLoss = 0.0;
constexpr int kScaleRounds = 4;           // maximum number of scalings of the known markers' covariances
constexpr double kSameCovariance = 0.04;  // relative difference
// Whether both maps have the same markers with about the same covariances.
bool haveSimilarCovariances(const MarkerMap& a, const MarkerMap& b) {
  if (a.markers().size() != b.markers().size()) return false;
  return std::all_of(a.markers().begin(), a.markers().end(), [&](const auto& entry) {
    const MappedMarker* other = b.find(entry.first);
    return other && entry.second.covariance.isApprox(other->covariance, kSameCovariance);
  });
}

class Making {
 public:
  Making(MarkerRecording recording, const MarkerSizes& sizes, const MarkerMap& known,
         const MappingParams& params)
      : params_(params), draft_(std::move(recording), sizes, known, params) {}

  MappingResult make() {
    draft_.make();
    settle();
    checkKnownMarkers();
    return result();
  }

  // Poses at all instants of a recording, of which those at the keyframes were estimated.
  BasePath path(MarkerRecording whole, const std::vector<size_t>& keyframes) const {
    return draft_.pathOf(std::move(whole), keyframes);
  }

 private:
  // Adjusts with the observations within the gate until their number no longer changes.
  void settle() {
    used_ = draft_.informative(draft_.fit.withinGate());
    for (int round = 0; round < kPlainRounds; ++round) {
      draft_.adjust(used_, kNoRobustLoss);
      draft_.locateRemainingInstants(used_);
      if (params_.estimate_noise) {
        draft_.fit.measureNoise(used_);
        draft_.correlated_images = draft_.fit.correlation(used_);
      }
      const size_t before = used_.size();
      used_ = draft_.informative(draft_.fit.withinGate());
      if (used_.size() == before && round > 0) break;
    }
    dropUnused();
    const auto covariance = mapCovariance(draft_.fit.measured(), used_, draft_.held, draft_.fit.estimate,
                                          draft_.adjustment(kNoRobustLoss));
    if (!covariance) throw std::runtime_error("the recording does not determine the pose of every marker");
    covariance_ = *covariance;
  }

  // Drops markers of which no observation is used, and those that the used ones do not connect with the
  // frame.
  void dropUnused() {
    std::set<MarkerKey> seen;
    for (const RecordedObservation& each : used_) seen.insert(detectionOf(draft_.fit.recording(), each).key);
    const auto connected = connectedMarkers(draft_.fit.recording(), used_, draft_.held);
    MarkerMap map(draft_.fit.estimate.map.frame());
    for (const auto& [key, marker] : draft_.fit.estimate.map.markers()) {
      if (connected.count(key) != 0 || draft_.known.find(key))
        map.add(marker);
      else if (seen.count(key) == 0)
        draft_.ambiguous.insert(key);
    }
    draft_.fit.estimate.map = map;
    used_.erase(std::remove_if(used_.begin(), used_.end(),
                               [&](const RecordedObservation& each) {
                                 return connected.count(detectionOf(draft_.fit.recording(), each).key) == 0;
                               }),
                used_.end());
  }

  // Stops using wrong known poses as priors, the worst first and one at a time: a wrong prior also makes
  // correct ones look wrong.
  void checkKnownMarkers() {
    for (MarkerMap believed = draft_.known;;) {
      scaleKnown(believed);
      const auto checks = checkKnown(draft_.held, draft_.fit.estimate.map, covariance_);
      const auto worst = std::max_element(checks.begin(), checks.end(), [](const auto& a, const auto& b) {
        return a.squared_distance < b.squared_distance;
      });
      if (worst == checks.end() || !worst->wrong) {
        checks_.insert(checks_.end(), checks.begin(), checks.end());
        return;
      }
      checks_.push_back(*worst);
      believed = withoutMarker(believed, worst->key);
    }
  }

  // Scales the covariances of the known markers up until their distances from the recording are not larger
  // than expected, and adjusts again.
  void scaleKnown(const MarkerMap& believed) {
    for (int round = 0; round < kScaleRounds; ++round) {
      scales_ = knownScales(believed, draft_.held, draft_.fit.estimate.map, covariance_);
      const MarkerMap scaled = scaledKnown(believed, scales_);
      if (haveSimilarCovariances(scaled, draft_.held)) return;
      draft_.held = scaled;
      settle();
    }
  }

  MappingResult result() const {
    MappingResult made;
    made.map = draft_.fit.estimate.map;
    Eigen::Index row = 0;
    for (auto [key, marker] : draft_.fit.estimate.map.markers()) {
      const Matrix6d P = covariance_.block<6, 6>(row, row);
      row += 6;
      if (draft_.known.find(key) && P.isZero(0.0))
        continue;  // exact, or never observed: keeps its entry as given
      marker.covariance = 0.5 * (P + P.transpose());
      made.map.set(marker);
    }
    made.covariance = covariance_;
    made.noise_scales = draft_.fit.noiseScales();
    made.lens_errors = draft_.fit.lensErrors();
    made.correlated_images = draft_.correlated_images;
    made.known_position_scale = scales_.position;
    made.known_rotation_scale = scales_.rotation;
    for (const RecordedObservation& each : draft_.fit.placed())
      made.residuals.push_back(draft_.fit.residual(each));
    made.known = checks_;
    made.ambiguous.assign(draft_.ambiguous.begin(), draft_.ambiguous.end());
    for (const auto& entry : draft_.fit.observations())
      if (!draft_.fit.estimate.map.find(entry.first) && draft_.ambiguous.count(entry.first) == 0)
        made.unconnected.push_back(entry.first);
    made.conflicting_poses = draft_.conflicting_poses;
    made.inconsistent.assign(draft_.inconsistent.begin(), draft_.inconsistent.end());
    return made;
  }

  const MappingParams& params_;
  MapDraft draft_;
  std::vector<RecordedObservation> used_;
  Eigen::MatrixXd covariance_;
  KnownScales scales_;
  std::vector<KnownMarkerCheck> checks_;
};

}  // namespace

ParamList MappingParams::fields() {
  const ParamList own = {
      {"corner_sigma", &corner_sigma, Range::openLow(0, 10), "px",
       "standard deviation of corner coordinates, common to all corners"},
      {"estimate_noise", &estimate_noise, Allowed(), "",
       "estimate a factor on `corner_sigma` for each camera from the residuals"},
      {"lens_sigma", &lens_sigma, Range::closed(0, 100), "px",
       "standard deviation of the errors of a camera's calibration (principal point, focal lengths and "
       "distortion, at half the diagonal from the centre), which are estimated; 0: exact"},
      {"robust_width", &robust_width, Range::closed(0.5, 1000), "",
       "threshold of the Huber loss of a marker in the first minimization, standard deviations"},
      {"gate", &gate, Range::closed(8, 1e6), "",
       "squared Mahalanobis distance beyond which an observation is excluded"},
      {"min_probability", &min_probability, Range::closed(0.5, 0.9999999), "",
       "minimum probability of a pose to be considered unambiguous"},
      {"floor_height_sigma", &floor_height_sigma, Range::closed(0, 10), "m",
       "standard deviation of the base's height above the plane z = 0 of the map; 0: no floor"},
      {"floor_tilt_sigma", &floor_tilt_sigma, Range::openLow(0, 1), "rad",
       "standard deviation of the base's roll and pitch, if `floor_height_sigma` is set"},
      {"threads", &threads, Range::closed(1, 64), "", "number of threads of the bundle adjustment"},
  };
  return joined({own, prefixed("odometry_", odometry.fields())});
}

MappingResult makeMarkerMap(MarkerRecording recording, const MarkerSizes& sizes, const MarkerMap& known,
                            const MappingParams& params) {
  validate(params);
  validate(sizes);
  const std::vector<size_t> found = keyframes(recording);
  MarkerRecording selected;
  for (const size_t i : found) selected.push_back(recording[i]);
  Making making(std::move(selected), sizes, known, params);
  MappingResult made = making.make();
  for (ObservationResidual& each : made.residuals) each.observation.instant = found[each.observation.instant];
  made.T_map_base = making.path(std::move(recording), found);
  return made;
}

}  // namespace sextant
