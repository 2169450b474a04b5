// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#include "sextant/localization/error_sums.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <numeric>

namespace sextant {
namespace {

constexpr double kMinCount = 100.0;      // residuals before large ones are limited
constexpr double kRobustWidth = 4.0;     // standard deviations of a marker's residual norm
constexpr int kNoiseRounds = 3;          // of the iteration for the noise
constexpr double kMaxExplained = 0.999;  // fraction of the noise that more errors explain

double logDeterminant(const Eigen::LLT<Eigen::MatrixXd>& cholesky) {
  return 2 * cholesky.matrixLLT().diagonal().array().log().sum();
}

Eigen::MatrixXd inverse(const Eigen::LLT<Eigen::MatrixXd>& cholesky) {
  const Eigen::Index n = cholesky.rows();
  return cholesky.solve(Eigen::MatrixXd::Identity(n, n));
}

std::vector<Eigen::Index> range(Eigen::Index first, Eigen::Index count) {
  std::vector<Eigen::Index> columns(static_cast<size_t>(count));
  std::iota(columns.begin(), columns.end(), first);
  return columns;
}

// Whitened residual (observation minus projection) of a marker and its Jacobians.
struct Whitened {
  Eigen::Matrix<double, 8, 1> residual;
  Eigen::Matrix<double, 8, 6> by_base;
  Eigen::Matrix<double, 8, 12> by_errors;  // size, camera (5), marker (6)
};

Whitened whitened(const MonitoredMarker& marker) {
  const MarkerLinearization& linear = marker.linearization;
  Whitened out{-linear.residual, linear.by_base, {}};
  out.by_errors << linear.by_size, marker.by_camera, linear.by_marker;
  for (int row = 0; row < 8; ++row) {
    const double scale = 1 / marker.sigmas[row / 2];
    out.residual[row] *= scale;
    out.by_base.row(row) *= scale;
    out.by_errors.row(row) *= scale;
  }
  return out;
}

}  // namespace

void ErrorPrior::add(const std::vector<Eigen::Index>& added, const Eigen::VectorXd& variances) {
  const Eigen::Index size = covariance.rows();
  covariance.conservativeResizeLike(Eigen::MatrixXd::Zero(size + variances.size(), size + variances.size()));
  covariance.diagonal().tail(variances.size()) = variances;
  columns.insert(columns.end(), added.begin(), added.end());
}

// ---- sums over the images -------------------------------------------------------------------------------

void ErrorSums::grow(Eigen::Index count) {
  const Eigen::Index size = H_.rows() + count;
  H_.conservativeResizeLike(Eigen::MatrixXd::Zero(size, size));
  b_.conservativeResizeLike(Eigen::VectorXd::Zero(size));
  values_.conservativeResizeLike(Eigen::VectorXd::Zero(size));
}

void ErrorSums::growFor(const std::vector<MonitoredMarker>& markers) {
  if (columns() == 0) grow(1);
  for (const MonitoredMarker& marker : markers) {
    while (cameras_.size() <= marker.camera) {
      cameras_.push_back(columns());
      grow(CameraErrors::kCount);
    }
    if (markers_.insert({marker.key, columns()}).second) grow(6);
  }
}

void ErrorSums::add(const std::vector<MonitoredMarker>& markers, double weight) {
  growFor(markers);
  const double limit = count_ > kMinCount ? kRobustWidth * std::sqrt(8 * squares_ / count_) : 1e6;
  Eigen::Matrix<double, Eigen::Dynamic, 6> B = Eigen::MatrixXd::Zero(columns(), 6);
  std::set<Eigen::Index> touched;
  Matrix6d information = Matrix6d::Zero();
  Vector6d gradient = Vector6d::Zero();
  double squares = 0, count = -6 * weight;
  for (const MonitoredMarker& marker : markers) {
    const Whitened each = whitened(marker);
    const double w = weight * std::min(1.0, limit / each.residual.norm());
    const Eigen::Index camera = cameras_[marker.camera], own = markers_.at(marker.key);
    const Eigen::Matrix<double, 12, 12> AtA = w * each.by_errors.transpose() * each.by_errors;
    const Eigen::Matrix<double, 12, 6> AtJ = w * each.by_errors.transpose() * each.by_base;
    const Eigen::Matrix<double, 12, 1> Atr = w * each.by_errors.transpose() * each.residual;
    const auto column = [&](int i) { return i == 0 ? kSize : i < 6 ? camera + i - 1 : own + i - 6; };
    for (int i = 0; i < 12; ++i) {
      for (int j = 0; j < 12; ++j) H_(column(i), column(j)) += AtA(i, j);
      B.row(column(i)) += AtJ.row(i);
      b_[column(i)] += Atr[i];
      touched.insert(column(i));
    }
    information += w * each.by_base.transpose() * each.by_base;
    gradient += w * each.by_base.transpose() * each.residual;
    squares += w * each.residual.squaredNorm();
    count += 8 * w;
  }
  const Eigen::LDLT<Matrix6d> pose(information);
  const Eigen::Matrix<double, 6, Eigen::Dynamic> eliminated = pose.solve(B.transpose());
  for (const Eigen::Index j : touched)
    for (const Eigen::Index i : touched) H_(i, j) -= B.row(i).dot(eliminated.col(j));
  b_ -= eliminated.transpose() * gradient;
  squares_ += squares - gradient.dot(pose.solve(gradient));
  count_ += count;
}

void ErrorSums::fade(double factor) { H_ *= factor, b_ *= factor, squares_ *= factor, count_ *= factor; }

void ErrorSums::remove(const Eigen::VectorXd& step) {
  squares_ += step.dot(H_ * step) - 2 * step.dot(b_);
  b_ -= H_ * step;
  values_ += step;
}

void ErrorSums::remove(Eigen::Index column, double step) {
  remove(Eigen::VectorXd(step * Eigen::VectorXd::Unit(columns(), column)));
}

void ErrorSums::eliminate(const MarkerKey& marker, const Vector6d& variances, double noise) {
  const Eigen::Index at = markers_.at(marker);
  Matrix6d own = H_.block<6, 6>(at, at);
  own.diagonal() += noise * variances.cwiseInverse();
  const Eigen::LDLT<Matrix6d> cholesky(own);
  const Eigen::MatrixXd rows = H_.middleRows<6>(at);
  const Vector6d right = b_.segment<6>(at);
  squares_ -= right.dot(cholesky.solve(right));
  H_ -= rows.transpose() * cholesky.solve(rows);
  b_ -= rows.transpose() * cholesky.solve(right);
  forget({marker});
}

void ErrorSums::keepMarkers(size_t most) {
  if (markers_.size() <= most) return;
  std::vector<std::pair<double, MarkerKey>> by_information;
  for (const auto& [key, at] : markers_) by_information.emplace_back(H_.diagonal().segment<3>(at).sum(), key);
  std::sort(by_information.begin(), by_information.end());
  std::set<MarkerKey> least;
  for (size_t i = 0; i + most < by_information.size(); ++i) least.insert(by_information[i].second);
  forget(least);
}

void ErrorSums::forget(const std::set<MarkerKey>& markers) {
  std::set<Eigen::Index> dropped;
  for (const MarkerKey& key : markers)
    for (const Eigen::Index column : range(markers_.at(key), 6)) dropped.insert(column);
  std::vector<Eigen::Index> kept;
  for (Eigen::Index i = 0; i < columns(); ++i)
    if (dropped.count(i) == 0) kept.push_back(i);
  for (const MarkerKey& key : markers) markers_.erase(key);
  const auto renumber = [&](Eigen::Index& column) {
    column = std::lower_bound(kept.begin(), kept.end(), column) - kept.begin();
  };
  for (Eigen::Index& column : cameras_) renumber(column);
  for (auto& entry : markers_) renumber(entry.second);
  H_ = information(kept, kept);
  b_ = selected(b_, kept);
  values_ = selected(values_, kept);
}

Eigen::MatrixXd ErrorSums::information(const std::vector<Eigen::Index>& rows,
                                       const std::vector<Eigen::Index>& columns) const {
  Eigen::MatrixXd block(rows.size(), columns.size());
  for (Eigen::Index j = 0; j < block.cols(); ++j)
    for (Eigen::Index i = 0; i < block.rows(); ++i) block(i, j) = H_(rows[i], columns[j]);
  return block;
}

Eigen::VectorXd ErrorSums::selected(const Eigen::VectorXd& all, const std::vector<Eigen::Index>& columns) {
  Eigen::VectorXd values(columns.size());
  for (Eigen::Index i = 0; i < values.size(); ++i) values[i] = all[columns[i]];
  return values;
}

// ---- evidence -------------------------------------------------------------------------------------------

// With the noise variance s, maximizes the logarithm of the evidence (MacKay, Information Theory, Inference,
// and Learning Algorithms, chapter 28)
// -n/2 log s - |residuals|^2 / 2s - theta' P^-1 theta / 2 - log |P^-1 + H / s| / 2 - log |P| / 2.
ErrorFit ErrorSums::fit(const ErrorPrior& prior, double min_noise) const {
  const auto n = static_cast<Eigen::Index>(prior.columns.size());
  ErrorFit out{0, 0, Eigen::VectorXd::Zero(n), Eigen::MatrixXd::Zero(n, n),
               std::max(squares_ / count_, min_noise)};
  const Eigen::MatrixXd H = information(prior.columns, prior.columns);
  const Eigen::VectorXd b = selected(b_, prior.columns), theta = selected(values_, prior.columns);
  const Eigen::LLT<Eigen::MatrixXd> prior_cholesky(prior.covariance);
  const Eigen::MatrixXd information = inverse(prior_cholesky);
  double squares = squares_, log_determinant = 0;
  for (int round = 0; round < kNoiseRounds; ++round) {
    const Eigen::LLT<Eigen::MatrixXd> cholesky(information + H / out.noise);
    out.step = cholesky.solve(b / out.noise - information * theta);
    out.covariance = inverse(cholesky);
    log_determinant = logDeterminant(cholesky);
    squares = squares_ - 2 * out.step.dot(b) + out.step.dot(H * out.step);
    const double explained = out.covariance.cwiseProduct(H).sum() / out.noise;
    out.noise = std::max(squares / std::max(count_ - explained, 1.0), min_noise);
  }
  const Eigen::VectorXd total = theta + out.step;
  out.penalty = total.dot(information * total);
  out.log_evidence = -0.5 * (count_ * std::log(out.noise) + squares / out.noise + out.penalty +
                             log_determinant + logDeterminant(prior_cholesky));
  return out;
}

double ErrorSums::gain(const ErrorPrior& prior, const ErrorFit& fit, const ErrorPrior& more) const {
  const Eigen::MatrixXd across = information(prior.columns, more.columns) / fit.noise;
  const Eigen::LLT<Eigen::MatrixXd> more_cholesky(more.covariance);
  const Eigen::LLT<Eigen::MatrixXd> cholesky(information(more.columns, more.columns) / fit.noise +
                                             inverse(more_cholesky) -
                                             across.transpose() * fit.covariance * across);
  const Eigen::VectorXd right = selected(b_, more.columns) / fit.noise - across.transpose() * fit.step;
  const double explained = std::min(right.dot(cholesky.solve(right)) / count_, kMaxExplained);
  return 0.5 * (-count_ * std::log(1 - explained) - logDeterminant(cholesky) - logDeterminant(more_cholesky));
}

}  // namespace sextant
