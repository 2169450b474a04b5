// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#include "map_information.hpp"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <algorithm>
#include <random>
#include <vector>

namespace sextant {
namespace {

constexpr int kBases = 5, kMap = 9;

// Random rows: each with a base pose and three parameters of the map, with two consecutive base poses if
// there is odometry, and with a parameter of the map alone.
Eigen::MatrixXd randomJacobian(bool odometry, int seed) {
  std::mt19937 random(seed);
  std::normal_distribution<double> normal(0, 1);
  std::vector<Eigen::VectorXd> rows;
  const auto add = [&](int from, int count, int map, int map_count) {
    Eigen::VectorXd row = Eigen::VectorXd::Zero(6 * kBases + kMap);
    for (int i = 0; i < count; ++i) row[6 * from + i] = normal(random);
    for (int i = 0; i < map_count; ++i) row[6 * kBases + (map + i) % kMap] = normal(random);
    rows.push_back(row);
  };
  for (int i = 0; i < 12 * kBases; ++i) add(i % kBases, 6, i, 3);
  for (int i = 0; odometry && i < 6 * (kBases - 1); ++i) add(i / 6, 12, 0, 0);
  add(0, 0, 4, 1);
  std::shuffle(rows.begin(), rows.end(), random);
  Eigen::MatrixXd jacobian(rows.size(), rows[0].size());
  for (size_t i = 0; i < rows.size(); ++i) jacobian.row(static_cast<Eigen::Index>(i)) = rows[i];
  return jacobian;
}

TEST(MapInformation, IsThatOfTheWholeInverse) {
  for (const bool odometry : {false, true}) {
    const Eigen::MatrixXd J = randomJacobian(odometry, 1);
    const auto found = mapParameterCovariance(J.sparseView(), kBases);
    ASSERT_TRUE(found);
    const Eigen::MatrixXd all = (J.transpose() * J).inverse();
    EXPECT_LT((*found - all.bottomRightCorner<kMap, kMap>()).norm(), 1e-10 * all.norm()) << odometry;
  }
}

TEST(MapInformation, IsNothingWhereAParameterIsNotDetermined) {
  Eigen::MatrixXd J = randomJacobian(true, 1);
  J.col(6 * kBases + 2).setZero();  // never seen
  EXPECT_FALSE(mapParameterCovariance(J.sparseView(), kBases));
  J = randomJacobian(true, 1);
  J.col(6 * kBases + 2) = J.col(6 * kBases + 1);  // only their sum
  EXPECT_FALSE(mapParameterCovariance(J.sparseView(), kBases));
  J = randomJacobian(true, 1);
  J.middleCols<2>(6).setZero();  // a base pose
  EXPECT_FALSE(mapParameterCovariance(J.sparseView(), kBases));
}

}  // namespace
}  // namespace sextant
