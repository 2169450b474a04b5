// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#include "landmark_costs.hpp"

#include <ceres/autodiff_cost_function.h>

#include <Eigen/Cholesky>
#include <utility>

namespace sextant {
namespace {

constexpr double kStanding = 1e-5;  // standard deviation of a robot that stands, m and rad
constexpr double kExact = 1e-6;     // of what is known exactly, m and rad

template <typename T>
using Vector2 = Eigen::Matrix<T, 2, 1>;

template <typename T>
Vector2<T> turned(const T& angle, const Vector2<T>& v) {
  using std::cos;
  using std::sin;
  return {cos(angle) * v.x() - sin(angle) * v.y(), sin(angle) * v.x() + cos(angle) * v.y()};
}

// Wrapped by a constant, which has no derivative.
double plain(double value) { return value; }
template <typename Jet>
double plain(const Jet& value) {
  return value.a;
}
template <typename T>
T wrappedAngle(const T& angle) {
  return angle - (plain(angle) - wrapped(plain(angle)));
}

Eigen::MatrixXd whitening(const Eigen::MatrixXd& covariance) {
  const Eigen::Index n = covariance.rows();
  return covariance.llt().matrixL().solve(Eigen::MatrixXd::Identity(n, n));
}

// X' = X exp(w) step, to the first order of w.
struct StepError {
  explicit StepError(const OdometryStep& odometry)
      : step(odometry), W(whitening(odometry.noise + kStanding * kStanding * Eigen::Matrix3d::Identity())) {}

  template <typename T>
  bool operator()(const T* a, const T* b, const T* scale, const T* turn_scale, T* residual) const {
    const T heading = step.step.heading + (*turn_scale - 1.0) * step.turn;
    const T off = wrappedAngle(T(b[2] - a[2] - heading));
    const Vector2<T> moved = turned(T(-a[2]), Vector2<T>(b[0] - a[0], b[1] - a[1]));
    const Vector2<T> expected = turned(off, Vector2<T>(*scale * step.step.position.cast<T>()));
    Eigen::Map<Eigen::Matrix<T, 3, 1>> all(residual);
    all << moved - expected, off;
    all = (W.cast<T>() * all).eval();
    return true;
  }

  OdometryStep step;
  Eigen::Matrix3d W;
};

// In the frame of the sensor.
template <int Rows>
struct SightingError {
  explicit SightingError(const LandmarkDrives::Sighting& sighting)
      : T_base_sensor(sighting.T_base_sensor),
        seen(sighting.T_base_sensor.inverse() * sighting.observation),
        W(whitening(seen.covariance.topLeftCorner<Rows, Rows>())) {}

  template <typename T>
  bool operator()(const T* pose, const T* landmark, const T* bearing, T* residual) const {
    const Vector2<T> off(landmark[0] - pose[0], landmark[1] - pose[1]);
    const Vector2<T> in_base = turned(T(-pose[2]), off) - T_base_sensor.position.cast<T>();
    const Vector2<T> in_sensor = turned(T(-T_base_sensor.heading), in_base);
    Eigen::Map<Eigen::Matrix<T, Rows, 1>> all(residual);
    all.template head<2>() = in_sensor - turned(*bearing, Vector2<T>(seen.position.cast<T>()));
    if constexpr (Rows == 3)
      all[2] = wrappedAngle(T(landmark[2] - pose[2] - T_base_sensor.heading - *seen.heading - *bearing));
    all = (W.template cast<T>() * all).eval();
    return true;
  }

  Pose2 T_base_sensor;
  Observation2D seen;
  Eigen::Matrix<double, Rows, Rows> W;
};

template <int Rows, int Size>
std::unique_ptr<ceres::CostFunction> sightingCostOf(const LandmarkDrives::Sighting& sighting) {
  using Cost = ceres::AutoDiffCostFunction<SightingError<Rows>, Rows, 3, Size, 1>;
  return std::make_unique<Cost>(new SightingError<Rows>(sighting));
}

struct ValueError {
  template <typename T>
  bool operator()(const T* value, T* residual) const {
    *residual = (*value - expected) / sigma;
    return true;
  }

  double expected, sigma;
};

// Linear but for the wrapped headings.
class KnownCost : public ceres::CostFunction {
 public:
  explicit KnownCost(const LandmarkDrives& measured)
      : W_(whitening(measured.covariance_of_known +
                     kExact * kExact *
                         Eigen::MatrixXd::Identity(measured.covariance_of_known.rows(),
                                                   measured.covariance_of_known.cols()))) {
    const auto add = [&](const Eigen::Vector2d& position, const std::optional<double>& heading) {
      mean_.push_back({position.x(), position.y(), heading.value_or(0.0)});
      mutable_parameter_block_sizes()->push_back(heading ? 3 : 2);
    };
    if (measured.first_pose) add(measured.first_pose->position, measured.first_pose->heading);
    for (const Landmark2D& each : measured.known) add(each.position, each.heading);
    set_num_residuals(static_cast<int>(W_.rows()));
  }

  bool Evaluate(double const* const* blocks, double* residuals, double** jacobians) const override {
    Eigen::VectorXd off(W_.rows());
    Eigen::Index row = 0;
    for (size_t i = 0; i < mean_.size(); ++i) {
      const Eigen::Index size = parameter_block_sizes()[i];
      for (Eigen::Index k = 0; k < size; ++k) {
        const double by = blocks[i][k] - mean_[i][static_cast<size_t>(k)];
        off[row + k] = k == 2 ? wrapped(by) : by;
      }
      if (jacobians && jacobians[i])
        Eigen::Map<Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>>(
            jacobians[i], W_.rows(), size) = W_.middleCols(row, size);
      row += size;
    }
    Eigen::Map<Eigen::VectorXd>(residuals, W_.rows()) = W_ * off;
    return true;
  }

 private:
  Eigen::MatrixXd W_;
  std::vector<PlanarBlock> mean_;
};

}  // namespace

std::unique_ptr<ceres::CostFunction> planarStepCost(const OdometryStep& step) {
  using Cost = ceres::AutoDiffCostFunction<StepError, 3, 3, 3, 1, 1>;
  return std::make_unique<Cost>(new StepError(step));
}

std::unique_ptr<ceres::CostFunction> sightingCost(const LandmarkDrives::Sighting& sighting,
                                                  const Landmark2D& landmark) {
  if (!landmark.heading) return sightingCostOf<2, 2>(sighting);
  return sighting.observation.heading ? sightingCostOf<3, 3>(sighting) : sightingCostOf<2, 3>(sighting);
}

std::unique_ptr<ceres::CostFunction> valueCost(double expected, double sigma) {
  using Cost = ceres::AutoDiffCostFunction<ValueError, 1, 1>;
  return std::make_unique<Cost>(new ValueError{expected, sigma});
}

std::unique_ptr<ceres::CostFunction> knownLandmarksCost(const LandmarkDrives& measured) {
  return std::make_unique<KnownCost>(measured);
}

}  // namespace sextant
