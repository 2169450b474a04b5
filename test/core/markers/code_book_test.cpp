// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#include "sextant/markers/code_book.hpp"

#include <gtest/gtest.h>

#include <random>

namespace sextant {
namespace {

constexpr int kSide = 6, kBits = kSide * kSide, kCodes = 500, kWidth = kSide + 4;

std::vector<cv::Point> places() {
  std::vector<cv::Point> places;
  for (int y = 0; y < kSide; ++y)
    for (int x = 0; x < kSide; ++x) places.emplace_back(x + 2, y + 2);
  return places;
}

Eigen::MatrixXf randomCodes() {
  std::mt19937 random(3);
  std::bernoulli_distribution bit;
  return Eigen::MatrixXf::NullaryExpr(kCodes, kBits, [&] { return bit(random) ? 1.0F : 0.0F; });
}

// Each code in a black border with a white one around it.
Eigen::MatrixXf printed(const Eigen::MatrixXf& codes) {
  Eigen::MatrixXf prints = Eigen::MatrixXf::Ones(codes.rows(), kWidth * kWidth);
  for (int y = 1; y < kWidth - 1; ++y)
    for (int x = 1; x < kWidth - 1; ++x) prints.col(y * kWidth + x).setZero();
  for (int i = 0; i < kBits; ++i) prints.col(places()[i].y * kWidth + places()[i].x) = codes.col(i);
  return prints;
}

CodeBook book() { return {printed(randomCodes()), kWidth, places()}; }

Eigen::VectorXf noisy(const Eigen::VectorXf& bits, double sigma, int seed) {
  std::mt19937 random(seed);
  std::normal_distribution<float> noise(0, static_cast<float>(sigma));
  return 40 + 20 * (bits + Eigen::VectorXf::NullaryExpr(kBits, [&] { return noise(random); })).array();
}

TEST(CodeBook, FindsTheCodeAmongNoise) {
  const Eigen::MatrixXf codes = randomCodes();
  const CodeBook book = sextant::book();
  int right = 0;
  for (int id = 0; id < kCodes; ++id)
    if (const auto match = book.match(noisy(codes.row(id), 0.2, id))) {
      EXPECT_EQ(match->id, id);
      EXPECT_EQ(match->rotation, 0);
      ++right;
    }
  EXPECT_GT(right, 0.9 * kCodes);
}

TEST(CodeBook, TellsHowTheMarkerIsTurned) {
  const Eigen::MatrixXf codes = randomCodes();
  const CodeBook book = sextant::book();
  Eigen::VectorXf bits = codes.row(9);
  for (int rotation = 0; rotation < 4; ++rotation) {
    const auto match = book.match(bits);
    ASSERT_TRUE(match);
    EXPECT_EQ(match->id, 9);
    EXPECT_EQ(match->rotation, rotation);
    EXPECT_EQ(book.resembles(bits, 9), rotation == 0);
    Eigen::VectorXf next(kBits);
    for (int i = 0; i < kBits; ++i) next[i % kSide * kSide + kSide - 1 - i / kSide] = bits[i];
    bits = next;
  }
}

// A motion to the right by two modules, at steps of half a module.
TEST(CodeBook, FindsTheCodeUnderMotionBlur) {
  const Eigen::MatrixXf codes = randomCodes(), prints = printed(codes);
  const CodeBook book = sextant::book();
  int right = 0, sharp = 0;
  for (int id = 0; id < kCodes; ++id) {
    Eigen::VectorXf greys(kBits);
    for (int i = 0; i < kBits; ++i) {
      const int at = places()[i].y * kWidth + places()[i].x;
      greys[i] = prints(id, at - 1) / 4 + prints(id, at) / 2 + prints(id, at + 1) / 4;
    }
    sharp += ((greys.array() > 0.5F) == (codes.row(id).transpose().array() > 0.5F)).all();
    if (const auto match = book.match(greys)) {
      EXPECT_EQ(match->id, id);
      ++right;
    }
    EXPECT_TRUE(book.resembles(greys, id));
  }
  EXPECT_LT(sharp, 0.1 * kCodes);
  EXPECT_GT(right, 0.9 * kCodes);
}

TEST(CodeBook, FindsNoneInRandomGreyLevels) {
  const CodeBook book = sextant::book();
  int expected = 0;
  for (int seed = 0; seed < 2000; ++seed) {
    const Eigen::VectorXf greys = noisy(Eigen::VectorXf::Zero(kBits), 1, seed);
    EXPECT_FALSE(book.match(greys));
    if (book.resembles(greys, 3)) ++expected;
  }
  EXPECT_LE(expected, 2);
  EXPECT_FALSE(book.match(Eigen::VectorXf::Constant(kBits, 90)));
  EXPECT_FALSE(book.resembles(Eigen::VectorXf::Constant(kBits, 90), 3));
}

}  // namespace
}  // namespace sextant
