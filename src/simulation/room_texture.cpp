// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#include "sextant/simulation/room_texture.hpp"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <string>

namespace sextant {
namespace {

constexpr double kTexelsPerMetre = 200.0;
constexpr double kLargestBoard = 3000.0;  // texels; limits the memory for large halls
/// An image with drawing functions in metres.
class Canvas {
 public:
  Canvas(double width, double height, double grey, std::uint64_t seed)
      : width_(width),
        height_(height),
        scale_(std::min(kTexelsPerMetre, kLargestBoard / std::max(width, height))),
        rng(seed) {
    const cv::Size size(std::max(1, texels(width)), std::max(1, texels(height)));
    image_ = cv::Mat(size, CV_8U, cv::Scalar(grey));
  }

  double width() const { return width_; }
  double height() const { return height_; }
  double random(double low, double high) { return rng.uniform(low, high); }

  void rectangle(double u, double v, double width, double height, double grey) {
    cv::rectangle(image_, box(u, v, width, height), cv::Scalar(grey), cv::FILLED);
  }
  void frame(double u, double v, double width, double height, double grey, double thickness) {
    cv::rectangle(image_, box(u, v, width, height), cv::Scalar(grey), line(thickness));
  }
  void circle(double u, double v, double radius, double grey) {
    cv::circle(image_, point(u, v), texels(radius), cv::Scalar(grey), cv::FILLED, cv::LINE_AA);
  }
  void stroke(double u0, double v0, double u1, double v1, double grey, double thickness) {
    cv::line(image_, point(u0, v0), point(u1, v1), cv::Scalar(grey), line(thickness), cv::LINE_AA);
  }
  void text(const std::string& words, double u, double v, double letter_height, double grey) {
    const double font_scale = letter_height * scale_ / 21.0;  // capitals of this font are 21 texels high at 1
    cv::putText(image_, words, point(u, v), cv::FONT_HERSHEY_SIMPLEX, font_scale, cv::Scalar(grey),
                line(0.15 * letter_height), cv::LINE_AA);
  }

  /// Adds smooth noise with a standard deviation of sigma grey levels and a wavelength of `scale` metres.
  void clouds(double scale, double sigma) {
    cv::Mat coarse(cv::Size(2 + static_cast<int>(width_ / scale), 2 + static_cast<int>(height_ / scale)),
                   CV_16S);
    rng.fill(coarse, cv::RNG::NORMAL, 0.0, sigma);
    cv::Mat fine;
    cv::resize(coarse, fine, image_.size(), 0, 0, cv::INTER_CUBIC);
    cv::add(image_, fine, image_, cv::noArray(), CV_8U);
  }

  RoomTexture texture() const { return RoomTexture(image_, width_, height_); }

 private:
  int texels(double metres) const { return static_cast<int>(std::lround(metres * scale_)); }
  int line(double thickness) const { return std::max(1, texels(thickness)); }
  cv::Point point(double u, double v) const { return {texels(u), texels(v)}; }
  cv::Rect box(double u, double v, double width, double height) const {
    return cv::Rect(point(u, v), point(u + width, v + height));
  }

  double width_;
  double height_;
  double scale_;  // texels per metre
  cv::Mat image_;

 public:
  cv::RNG rng;
};

void paintStripes(Canvas* wall, double u, double v, double size) {
  for (double x = 0.0; x < size; x += 0.16 * size) {
    wall->rectangle(u + x, v, 0.08 * size, 1.3 * size, wall->random(10, 90));
  }
}

void paintDiscs(Canvas* wall, double u, double v, double size) {
  for (int i = 0; i < 7; ++i) {
    const double radius = size * wall->random(0.05, 0.15);
    wall->circle(u + size * wall->random(0.15, 0.85), v + size * wall->random(0.15, 1.15), radius,
                 wall->random(10, 230));
  }
}

void paintWords(Canvas* wall, double u, double v, double size) {
  wall->text("EXIT 7", u + 0.05 * size, v + 0.25 * size, 0.15 * size, 15);
  for (double y = 0.4 * size; y < 1.2 * size; y += 0.1 * size) {
    wall->text("the quick brown fox", u + 0.05 * size, v + y, 0.05 * size, 40);
  }
}

void paintSquares(Canvas* wall, double u, double v, double size) {
  for (int i = 0; i < 12; ++i) {
    const double side = size * wall->random(0.06, 0.2);
    wall->rectangle(u + size * wall->random(0.05, 0.75), v + size * wall->random(0.05, 1.05), side, side,
                    wall->random(0, 200));
  }
}

void paintPosters(Canvas* wall) {
  using Painter = void (*)(Canvas*, double, double, double);
  const Painter painters[] = {paintStripes, paintDiscs, paintWords, paintSquares};
  const int first = wall->rng.uniform(0, 4);
  const int count = std::min(64, static_cast<int>(wall->width() / 1.2));
  for (int i = 0; i < count; ++i) {
    const double size = wall->random(0.35, 0.6);
    const double u = (i + wall->random(0.2, 0.6)) * wall->width() / count;
    const double v = wall->random(0.15, 0.4) * wall->height();
    wall->rectangle(u, v, size, 1.3 * size, wall->random(190, 235));
    painters[(first + i) % 4](wall, u, v, size);
    wall->frame(u, v, size, 1.3 * size, wall->random(20, 80), 0.02);
  }
}

void paintDoor(Canvas* wall) {
  const double height = std::min(2.0, 0.85 * wall->height());
  const double u = wall->random(0.05, 0.8) * wall->width();
  wall->rectangle(u, wall->height() - height, 0.9, height, 100);
  wall->frame(u, wall->height() - height, 0.9, height, 60, 0.04);
  wall->circle(u + 0.8, wall->height() - 0.5 * height, 0.03, 220);
}

void paintShelves(Canvas* wall) {
  const double u = wall->random(0.1, 0.7) * wall->width();
  for (double v = 0.3; v < 1.0; v += 0.35) {
    const double shelf = wall->height() - v;
    for (double x = 0.02; x < 1.1; x += 0.07) {  // books
      const double book = wall->random(0.15, 0.28);
      wall->rectangle(u + x, shelf - book, 0.055, book, wall->random(30, 220));
    }
    wall->rectangle(u, shelf, 1.15, 0.025, 70);
  }
}

}  // namespace

RoomTexture::RoomTexture(const cv::Mat& image, double width, double height)
    : texel_(static_cast<float>(width / image.cols)) {
  cv::Mat level = image;
  while (true) {
    levels_.push_back(
        {level, static_cast<float>(level.cols / width), static_cast<float>(level.rows / height)});
    if (std::max(level.cols, level.rows) == 1) break;
    cv::Mat half;
    cv::resize(level, half, cv::Size((level.cols + 1) / 2, (level.rows + 1) / 2), 0, 0, cv::INTER_AREA);
    level = half;
  }
}

RoomTexture paintWall(double width, double height, std::uint64_t seed) {
  Canvas wall(width, height, 185, seed);
  paintDoor(&wall);
  paintShelves(&wall);
  paintPosters(&wall);
  for (int i = 0; i < 3; ++i) {  // cables
    wall.stroke(wall.random(0, width), wall.random(0, height), wall.random(0, width), wall.random(0, height),
                40, 0.01);
  }
  wall.rectangle(0, height - 0.1, width, 0.1, 50);
  wall.clouds(0.5, 8);
  wall.clouds(0.03, 4);
  return wall.texture();
}

RoomTexture paintFloor(double width, double height, std::uint64_t seed) {
  Canvas floor(width, height, 60, seed);
  constexpr double kTile = 0.4;
  for (double u = 0.0; u < width; u += kTile) {
    for (double v = 0.0; v < height; v += kTile) {
      floor.rectangle(u, v, kTile - 0.01, kTile - 0.01, floor.random(100, 150));
    }
  }
  floor.clouds(0.05, 6);
  return floor.texture();
}

RoomTexture paintCeiling(double width, double height, std::uint64_t seed) {
  Canvas ceiling(width, height, 150, seed);
  constexpr double kPanel = 0.6;
  for (double u = 0.0; u < width; u += kPanel) {
    for (double v = 0.0; v < height; v += kPanel) {
      const bool lamp = ceiling.random(0, 1) < 0.1;
      ceiling.rectangle(u, v, kPanel - 0.02, kPanel - 0.02, lamp ? 250 : ceiling.random(200, 215));
    }
  }
  return ceiling.texture();
}

}  // namespace sextant
