// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#include "sextant/localization/error_sums.hpp"

#include <gtest/gtest.h>

#include <Eigen/QR>
#include <random>

namespace sextant {
namespace {

constexpr int kImages = 6, kMarkers = 3, kRows = 8 * kMarkers;

// Images of three markers with random derivatives and residuals, and the same problem with the poses of all
// images as unknowns, after the size.
struct RandomProblem {
  std::vector<std::vector<MonitoredMarker>> images;
  Eigen::MatrixXd A = Eigen::MatrixXd::Zero(kImages * kRows, 1 + 6 * kImages);
  Eigen::VectorXd r{kImages * kRows};

  RandomProblem() {
    std::mt19937 random(3);
    std::normal_distribution<double> number(0, 1);
    const auto fill = [&](auto& matrix) {
      for (Eigen::Index i = 0; i < matrix.size(); ++i) matrix.data()[i] = number(random);
    };
    for (int image = 0; image < kImages; ++image) {
      images.emplace_back();
      for (int id = 0; id < kMarkers; ++id) {
        MonitoredMarker marker;
        marker.key = {"tag36h11", id};
        marker.sigmas.fill(0.5);
        fill(marker.linearization.residual);
        fill(marker.linearization.by_base);
        fill(marker.linearization.by_marker);
        fill(marker.linearization.by_size);
        fill(marker.by_camera);
        const Eigen::Index row = image * kRows + 8 * id;
        A.block<8, 1>(row, 0) = marker.linearization.by_size / 0.5;
        A.block<8, 6>(row, 1 + 6 * image) = marker.linearization.by_base / 0.5;
        r.segment<8>(row) = -marker.linearization.residual / 0.5;
        images.back().push_back(marker);
      }
    }
  }

  ErrorSums sums() const {
    ErrorSums sums;
    for (const auto& image : images) sums.add(image, 1.0);
    return sums;
  }
};

ErrorPrior flatSize() {
  ErrorPrior prior;
  prior.add({ErrorSums::kSize}, Eigen::VectorXd::Constant(1, 1e9));
  return prior;
}

TEST(ErrorSums, GiveTheSolutionOfTheProblemWithAllPoses) {
  const RandomProblem problem;
  const Eigen::VectorXd x = problem.A.colPivHouseholderQr().solve(problem.r);
  const double squares = (problem.r - problem.A * x).squaredNorm();
  const ErrorFit fit = problem.sums().fit(flatSize());
  EXPECT_NEAR(fit.step[0], x[0], 1e-6);
  EXPECT_NEAR(fit.noise, squares / (kImages * kRows - 6 * kImages - 1), 1e-6);
}

TEST(ErrorSums, ARemovedErrorIsGone) {
  ErrorSums sums = RandomProblem().sums();
  const double step = sums.fit(flatSize()).step[0], noise = sums.fit(flatSize()).noise;
  sums.remove(ErrorSums::kSize, step);
  EXPECT_NEAR(sums.fit(flatSize()).step[0], 0, 1e-9);
  EXPECT_NEAR(sums.fit(flatSize()).noise, noise, 1e-9);
  EXPECT_EQ(sums.values()[ErrorSums::kSize], step);
}

// An eliminated marker with a wide prior is as one whose errors are estimated with this prior.
TEST(ErrorSums, AnEliminatedMarkerIsIntegratedOut) {
  ErrorSums sums = RandomProblem().sums();
  ErrorPrior with = flatSize();
  const Eigen::Index at = sums.markers().at({"tag36h11", 1});
  with.add({at, at + 1, at + 2, at + 3, at + 4, at + 5}, Eigen::VectorXd::Constant(6, 1e9));
  const double expected = sums.fit(with).step[0];
  sums.eliminate({"tag36h11", 1}, Vector6d::Constant(1e9), 1.0);
  EXPECT_NEAR(sums.fit(flatSize()).step[0], expected, 1e-6);
  EXPECT_EQ(sums.markers().size(), 2u);
  EXPECT_EQ(sums.columns(), 1 + CameraErrors::kCount + 12);
}

TEST(ErrorSums, GainIsThatOfTheEvidence) {
  const ErrorSums sums = RandomProblem().sums();
  const ErrorPrior size = flatSize();
  const ErrorFit fit = sums.fit(size);
  ErrorPrior more, both = size;
  const Eigen::Index at = sums.markers().at({"tag36h11", 2});
  more.add({at, at + 1, at + 2}, Eigen::VectorXd::Constant(3, 0.04));
  both.add({at, at + 1, at + 2}, Eigen::VectorXd::Constant(3, 0.04));
  EXPECT_NEAR(sums.gain(size, fit, more), sums.fit(both).log_evidence - fit.log_evidence, 0.3);
}

}  // namespace
}  // namespace sextant
