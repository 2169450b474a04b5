// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#include "sextant/simulation/room_renderer.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <opencv2/core.hpp>
#include <string>

#include "test_cameras.hpp"

namespace sextant {
namespace {

constexpr double kPi = 3.14159265358979323846;

struct Lens {
  std::string name;
  std::string model;
  std::vector<double> D;
  double focal_length;
};

CameraModel cameraWith(const Lens& lens) {
  CameraCalibration c;
  c.width = 640;
  c.height = 480;
  c.distortion_model = lens.model;
  c.D = lens.D;
  c.K << lens.focal_length, 0, 322.3, 0, lens.focal_length + 1.7, 237.9, 0, 0, 1;
  c.P.leftCols<3>() = c.K;
  return CameraModel(c, CameraModel::Image::raw);
}

MarkerMap oneMarker() {
  MarkerMap map;
  map.add({{"tag36h11", 5},
           0.2,
           "",
           poseFromXyzRpy({3.0, 0.0, 1.0}, {kPi / 2, 0.0, -kPi / 2}),
           Matrix6d::Zero()});
  return map;
}

std::shared_ptr<const RoomScene> evenlyLitRoom() {
  RoomSceneParams params;
  params.light_unevenness = 0.0;
  return std::make_shared<RoomScene>(params, oneMarker());
}

RoomRendererParams clean() {
  RoomRendererParams params;
  params.noise_sigma = 0.0;
  params.vignette = 0.0;
  return params;
}

double bilinear(const cv::Mat& image, const Eigen::Vector2d& p) {
  const int x = static_cast<int>(p.x()), y = static_cast<int>(p.y());
  const double a = p.x() - x, b = p.y() - y;
  const auto grey = [&image](int row, int column) {
    return static_cast<double>(image.at<std::uint8_t>(row, column));
  };
  return (1 - b) * ((1 - a) * grey(y, x) + a * grey(y, x + 1)) +
         b * ((1 - a) * grey(y + 1, x) + a * grey(y + 1, x + 1));
}

// Distance of the rendered edge of the black border from its CameraModel::project(), pixels outward, at one
// place of one side: the integral of the darkness along the side's normal, from one module inside to one
// outside.
double edgeOffset(const cv::Mat& image, const CameraModel& camera, const Pose& T_camera_marker, int side,
                  double along) {
  constexpr double kModule = 0.2 / 8, kReach = 0.9 * kModule;
  constexpr int kSteps = 200;
  const Eigen::Rotation2Dd turn(side * kPi / 2);
  const auto pixel = [&](double outward) {
    const Eigen::Vector2d p = turn * Eigen::Vector2d(along, 0.1 + outward);
    return *camera.project(T_camera_marker * Eigen::Vector3d(p.x(), p.y(), 0.0));
  };
  const double black = bilinear(image, pixel(-0.5 * kModule)), white = bilinear(image, pixel(0.5 * kModule));
  double darkness = 0.0;
  for (int i = 0; i < kSteps; ++i) {
    const double outward = kReach * (2.0 * (i + 0.5) / kSteps - 1.0);
    darkness += (white - bilinear(image, pixel(outward))) / (white - black) * 2.0 * kReach / kSteps;
  }
  const double pixels_per_metre = (pixel(0.001) - pixel(-0.001)).norm() / 0.002;
  return (darkness - kReach) * pixels_per_metre;
}

class RoomRendererLens : public testing::TestWithParam<Lens> {};

TEST_P(RoomRendererLens, PrintsAppearExactlyWhereTheCameraModelProjectsThem) {
  const CameraModel camera = cameraWith(GetParam());
  const RoomRenderer renderer(clean(), evenlyLitRoom(), camera);
  const Pose T_map_marker = oneMarker().find({"tag36h11", 5})->T_map_marker;
  double sum_of_all = 0.0;
  int count_of_all = 0;
  for (const auto& [p, rpy] : std::vector<std::pair<Eigen::Vector3d, Eigen::Vector3d>>{
           {{2.0, 0.0, 1.0}, {0.0, 0.0, 0.0}},     // straight on: edges along the pixel grid
           {{2.1, 0.25, 1.1}, {0.2, 0.05, 0.05}},  // turned about the view
           {{2.2, -0.5, 0.8}, {0.1, -0.1, 0.35}},  // from the side, near the image's border
           {{2.05, 0.25, 1.2}, {-0.3, 0.15, -0.4}}}) {
    const Pose T_map_camera = cameraPose(p, rpy);
    const cv::Mat image = renderer.render({T_map_camera}, 0);
    for (const Eigen::Vector3d& corner : markerCorners(0.25)) {
      const Eigen::Vector2d pixel = *camera.project(T_map_camera.inverse() * T_map_marker * corner);
      ASSERT_TRUE(cv::Rect2d(0, 0, 638, 478).contains({pixel.x(), pixel.y()})) << pixel.transpose();
    }
    for (int side = 0; side < 4; ++side) {
      double sum = 0.0;
      int count = 0;
      for (double along = -0.08; along <= 0.08; along += 0.002, ++count) {
        sum += edgeOffset(image, camera, T_map_camera.inverse() * T_map_marker, side, along);
      }
      EXPECT_NEAR(sum / count, 0.0, 0.04) << "side " << side << " seen from " << p.transpose();
      sum_of_all += sum;
      count_of_all += count;
    }
  }
  EXPECT_NEAR(sum_of_all / count_of_all, 0.0, 0.02);
}

INSTANTIATE_TEST_SUITE_P(AllModels, RoomRendererLens,
                         testing::Values(Lens{"Ideal", "plumb_bob", {0, 0, 0, 0, 0}, 530},
                                         Lens{"Barrel", "plumb_bob", {-0.25, 0.08, 0.001, -0.002, 0.0}, 530},
                                         Lens{"Rational",
                                              "rational_polynomial",
                                              {0.4, -0.1, 0.001, 0.001, 0.02, 0.7, -0.05, 0.01},
                                              530},
                                         Lens{"Fisheye", "equidistant", {-0.02, 0.004, 0.001, 0.0}, 400}),
                         [](const auto& info) { return info.param.name; });

TEST(RoomRenderer, TheSameSeedAndFrameGiveTheSameBytes) {
  const CameraModel camera = cameraWith({"", "plumb_bob", {0, 0, 0, 0, 0}, 530});
  const auto scene = std::make_shared<RoomScene>(RoomSceneParams(), oneMarker());
  RoomRendererParams params;
  const Pose T_map_camera = cameraPose({0, 0, 1}, {0, 0, 0.3});
  const cv::Mat image = RoomRenderer(params, scene, camera).render({T_map_camera}, 7);
  const auto differs = [&image](const cv::Mat& other) { return cv::countNonZero(image != other) > 1000; };
  const RoomRenderer again(params, scene, camera);
  EXPECT_TRUE(differs(again.render({T_map_camera}, 8)));
  EXPECT_EQ(cv::countNonZero(image != again.render({T_map_camera}, 7)), 0);
  params.seed = 2;
  EXPECT_TRUE(differs(RoomRenderer(params, scene, camera).render({T_map_camera}, 7)));
}

TEST(RoomRenderer, NoiseHasTheSpreadThatWasAskedFor) {
  const CameraModel camera = cameraWith({"", "plumb_bob", {0, 0, 0, 0, 0}, 530});
  RoomRendererParams params = clean();
  const Pose T_map_camera = cameraPose({0, 0, 1}, {0, 0, 0.3});
  const cv::Mat without = RoomRenderer(params, evenlyLitRoom(), camera).render({T_map_camera}, 0);
  params.noise_sigma = 4.0;
  const RoomRenderer noisy(params, evenlyLitRoom(), camera);
  cv::Mat noise[2];
  for (int frame = 0; frame < 2; ++frame) {
    cv::subtract(noisy.render({T_map_camera}, frame), without, noise[frame], cv::noArray(), CV_32F);
  }
  cv::Scalar mean, sigma;
  cv::meanStdDev(noise[0], mean, sigma);
  EXPECT_NEAR(mean[0], 0.0, 0.05);
  EXPECT_NEAR(sigma[0], 4.0, 0.1);
  EXPECT_NEAR(noise[0].dot(noise[1]) / (16.0 * noise[0].total()), 0.0, 0.02);  // frames are independent
}

TEST(RoomRenderer, VignetteDarkensTheCorners) {
  const CameraModel camera = cameraWith({"", "plumb_bob", {0, 0, 0, 0, 0}, 530});
  RoomRendererParams params = clean();
  const Pose T_map_camera = cameraPose({0, 0, 1}, {0, 0, 0.3});
  const cv::Mat even = RoomRenderer(params, evenlyLitRoom(), camera).render({T_map_camera}, 0);
  params.vignette = 0.4;
  const cv::Mat dark = RoomRenderer(params, evenlyLitRoom(), camera).render({T_map_camera}, 0);
  const auto ratio = [&](int y, int x) {
    return static_cast<double>(dark.at<uchar>(y, x)) / even.at<uchar>(y, x);
  };
  EXPECT_NEAR(ratio(0, 0), 0.6, 0.02);
  EXPECT_NEAR(ratio(240, 320), 1.0, 0.02);
}

TEST(RoomRenderer, AMovingExposureIsTheMeanOfItsMoments) {
  const CameraModel camera = cameraWith({"", "plumb_bob", {0, 0, 0, 0, 0}, 530});
  const RoomRenderer renderer(clean(), evenlyLitRoom(), camera);
  const Pose first = cameraPose({0, 0, 1}, {0, 0, 0.0}), second = cameraPose({0, 0, 1}, {0, 0, 0.02});
  cv::Mat mean, difference;
  cv::addWeighted(renderer.render({first}, 0), 0.5, renderer.render({second}, 0), 0.5, 0.0, mean);
  cv::absdiff(renderer.render({first, second}, 0), mean, difference);
  EXPECT_LE(cv::norm(difference, cv::NORM_INF), 1.0);  // rounding
}

TEST(RoomRenderer, IsBlackWhereTheLensHasNoRay) {
  // 1 + 3 k1 r^2 = 0 at r = 0.816: the model's image ends 0.544 f = 109 px from the middle
  const CameraModel camera = cameraWith({"", "plumb_bob", {-0.5, 0, 0, 0, 0}, 200});
  const RoomRenderer renderer(clean(), evenlyLitRoom(), camera);
  const cv::Mat image = renderer.render({cameraPose({0, 0, 1}, {0, 0, 0.3})}, 0);
  EXPECT_EQ(image.at<uchar>(238, 20), 0);
  EXPECT_EQ(image.at<uchar>(20, 322), 0);
  EXPECT_GT(image.at<uchar>(238, 322), 20);
}

TEST(RoomRenderer, RefusesWhatCannotBe) {
  const CameraModel camera = cameraWith({"", "plumb_bob", {0, 0, 0, 0, 0}, 530});
  const RoomRenderer renderer(clean(), evenlyLitRoom(), camera);
  EXPECT_THROW(renderer.render({}, 0), std::invalid_argument);
  EXPECT_THROW(renderer.render({cameraPose({4, 0, 1}, {0, 0, 0})}, 0), std::invalid_argument);
  EXPECT_THROW(RoomRenderer(clean(), nullptr, camera), std::invalid_argument);
  const auto refused = [](auto change) {
    RoomRendererParams params;
    change(params);
    EXPECT_THROW(validate(params), std::invalid_argument);
  };
  refused([](RoomRendererParams& p) { p.supersampling = 0; });
  refused([](RoomRendererParams& p) { p.blur_sigma = -0.1; });
  refused([](RoomRendererParams& p) { p.noise_sigma = 101; });
  refused([](RoomRendererParams& p) { p.vignette = 1.1; });
  refused([](RoomRendererParams& p) { p.white_level = 0; });
  refused([](RoomRendererParams& p) { p.seed = -1; });
}

}  // namespace
}  // namespace sextant
