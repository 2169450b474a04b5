// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#include "sextant/simulation/room_renderer.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <opencv2/imgproc.hpp>
#include <stdexcept>
#include <string>

namespace sextant {
namespace {

constexpr int kRenderTile = 16;            // pixels
constexpr int kRenderNoise = 1 << 20;      // much longer than a row, so that no pattern is visible
constexpr std::uint16_t kFine = 1U << 15;  // flag of surfaces with details smaller than pixels
constexpr float kFineDetail = 2.5F;        // pixels

/// Points in a unit square, no two in one row or column (Korobov lattice), so that edges along the pixel grid
/// are resolved as finely as others.
std::vector<Eigen::Vector2f> latticePoints(int count) {
  int step = static_cast<int>(std::lround(0.618 * count));  // golden section
  while (std::max(1, step) < count && std::__gcd(step, count) != 1) ++step;
  std::vector<Eigen::Vector2f> points;
  for (int i = 0; i < count; ++i) {
    const Eigen::Vector2f cell(static_cast<float>(i), static_cast<float>((i * step) % count));
    points.emplace_back((cell.array() + 0.5F) / static_cast<float>(count) - 0.5F);
  }
  return points;
}

/// 255 at pixels at or next to an edge.
cv::Mat_<std::uint8_t> edgePixels(const cv::Mat_<std::uint16_t>& surfaces) {
  cv::Mat low, high, edges;
  cv::erode(surfaces, low, cv::Mat());
  cv::dilate(surfaces, high, cv::Mat());
  cv::compare(low, high, edges, cv::CMP_NE);
  return edges | (surfaces >= kFine);
}

}  // namespace

// A part of the image and the objects in it.
struct RoomRenderer::Tile {
  cv::Rect area;
  std::vector<int> objects;
};

// An image during rendering.
struct RoomRenderer::Shot {
  Eigen::Isometry3f T_map_camera;
  cv::Mat_<float> light;
  cv::Mat_<std::uint16_t> surfaces;  // 0: no ray
};

ParamList RoomRendererParams::fields() {
  return {
      {"supersampling", &supersampling, Range::closed(1, 16), "", "n * n rays per pixel at edges"},
      {"blur_sigma", &blur_sigma, Range::closed(0, 20), "px", "standard deviation of the lens blur"},
      {"noise_sigma", &noise_sigma, Range::closed(0, 100), "grey levels",
       "standard deviation of the sensor noise"},
      {"vignette", &vignette, Range::closed(0, 1), "", "fraction of the light lost in the image corners"},
      {"white_level", &white_level, Range::openLow(0, 1000), "grey levels",
       "grey level of white paper in the room's mean light"},
      {"seed", &seed, Range::closed(0, std::numeric_limits<int>::max()), "", "seed of the noise"},
  };
}

RoomRenderer::RoomRenderer(const RoomRendererParams& params, std::shared_ptr<const RoomScene> scene,
                           const CameraModel& camera)
    : params_(params),
      scene_(std::move(scene)),
      camera_(camera),
      pixel_angle_(static_cast<float>(1.0 / camera.focalLength())),
      samples_(latticePoints(params.supersampling * params.supersampling)),
      noise_(kRenderNoise) {
  validate(params);
  if (!scene_) throw std::invalid_argument("RoomRenderer: no scene");
  makeRays();
  makeVignette();
  cv::RNG rng(static_cast<std::uint64_t>(params.seed) + 1);
  cv::Mat_<float> noise(1, kRenderNoise, noise_.data());
  rng.fill(noise, cv::RNG::NORMAL, 0.0, 1.0);
}

void RoomRenderer::makeRays() {
  rays_.reserve(static_cast<std::size_t>(camera_.width() + 2) * (camera_.height() + 2));
  for (int y = -1; y <= camera_.height(); ++y) {
    for (int x = -1; x <= camera_.width(); ++x) {
      const auto ray = camera_.unproject({x, y});
      rays_.emplace_back(ray ? ray->cast<float>().eval() : Eigen::Vector3f::Zero());
    }
  }
}

void RoomRenderer::makeVignette() {
  gain_.create(camera_.height(), camera_.width());
  const Eigen::Vector2d middle(0.5 * (camera_.width() - 1), 0.5 * (camera_.height() - 1));
  for (int y = 0; y < gain_.rows; ++y) {
    for (int x = 0; x < gain_.cols; ++x) {
      const double share =
          (Eigen::Vector2d(x, y) - middle).squaredNorm() / std::max(1.0, middle.squaredNorm());
      gain_(y, x) = static_cast<float>(params_.white_level * (1.0 - params_.vignette * share));
    }
  }
}

cv::Mat RoomRenderer::render(const std::vector<Pose>& exposure, std::uint64_t frame) const {
  if (exposure.empty()) throw std::invalid_argument("render: no pose");
  cv::Mat_<float> light;
  for (const Pose& T_map_camera : exposure) {
    if (!isFinite(T_map_camera) || !scene_->contains(T_map_camera.translation())) {
      throw std::invalid_argument("render: the camera is outside the room");
    }
    const cv::Mat_<float> instant = radiance(T_map_camera);
    light = light.empty() ? instant : cv::Mat_<float>(light + instant);
  }
  if (exposure.size() > 1) light /= static_cast<double>(exposure.size());
  if (params_.blur_sigma > 0.0) cv::GaussianBlur(light, light, cv::Size(), params_.blur_sigma);
  return expose(light, frame);
}

cv::Mat_<float> RoomRenderer::radiance(const Pose& T_map_camera) const {
  const cv::Size size(camera_.width(), camera_.height());
  Shot shot{T_map_camera.cast<float>(), cv::Mat_<float>(size, 0.0F), cv::Mat_<std::uint16_t>(size, 0)};
  const std::vector<Tile> parts = tiles(T_map_camera);
  for (const Tile& tile : parts) traceTile(tile, &shot);
  const cv::Mat_<std::uint8_t> edges = edgePixels(shot.surfaces);
  for (const Tile& tile : parts) refineTile(tile, edges, &shot);
  return shot.light;
}

std::vector<RoomRenderer::Tile> RoomRenderer::tiles(const Pose& T_map_camera) const {
  const cv::Rect image(0, 0, camera_.width(), camera_.height());
  std::vector<Tile> tiles;
  for (int y = 0; y < image.height; y += kRenderTile) {
    for (int x = 0; x < image.width; x += kRenderTile)
      tiles.push_back({cv::Rect(x, y, kRenderTile, kRenderTile) & image, {}});
  }
  const Pose T_camera_map = T_map_camera.inverse();
  for (int object = 0; object < scene_->objectCount(); ++object) {
    const cv::Rect box = boundingBox(object, T_camera_map);
    for (Tile& tile : tiles) {
      if ((tile.area & box).area() > 0) tile.objects.push_back(object);
    }
  }
  return tiles;
}

cv::Rect RoomRenderer::boundingBox(int object, const Pose& T_camera_map) const {
  const cv::Rect image(0, 0, camera_.width(), camera_.height());
  std::vector<cv::Point2f> pixels;
  const auto points = scene_->outline(object);
  for (const Eigen::Vector3d& p_map : points) {
    const auto pixel = camera_.project(T_camera_map * p_map);
    if (pixel) pixels.emplace_back(static_cast<float>(pixel->x()), static_cast<float>(pixel->y()));
  }
  if (pixels.empty()) return {};
  if (pixels.size() < points.size()) return image;  // partly behind the camera
  cv::Rect2f box = cv::boundingRect(pixels);
  // Between the outline's points, lens distortion may bend lines outwards.
  const float margin = 3.0F + 0.02F * std::max(box.width, box.height);
  box += cv::Size2f(2 * margin, 2 * margin);
  box -= cv::Point2f(margin, margin);
  return cv::Rect(box & cv::Rect2f(image));
}

void RoomRenderer::traceTile(const Tile& tile, Shot* shot) const {
  const int background = traceFace(tile, shot);
  if (background < 0 || !tile.objects.empty()) tracePixels(tile, background, shot);
}

// If all corners of a tile see the same side of the room, this is the only background of the tile. Returns
// that side, or -1.
int RoomRenderer::traceFace(const Tile& tile, Shot* shot) const {
  const cv::Rect& a = tile.area;
  RoomRay ray{shot->T_map_camera.translation(), {}};
  float light[4];
  RoomHit hit{};
  for (int i = 0; i < 4; ++i) {
    const Eigen::Vector3f& direction = rayAt(a.x + (i % 2) * (a.width - 1), a.y + (i / 2) * (a.height - 1));
    if (direction.isZero()) return -1;
    ray.direction = shot->T_map_camera.linear() * direction;
    const int face = hit.surface;
    hit = scene_->trace(ray, {});
    if (i > 0 && hit.surface != face) return -1;
    light[i] = scene_->illumination(ray.origin + hit.distance * ray.direction);
  }
  for (int y = 0; y < a.height; ++y) {  // light changes slowly, so it is interpolated
    float* row = shot->light[a.y + y] + a.x;
    scene_->faceReflectance(hit.surface, shot->T_map_camera, &rayAt(a.x, a.y + y), a.width,
                            hit.distance * pixel_angle_, row);
    const float down = static_cast<float>(y) / static_cast<float>(kRenderTile - 1);
    const float left = light[0] + down * (light[2] - light[0]);
    const float step = (light[1] + down * (light[3] - light[1]) - left) / static_cast<float>(kRenderTile - 1);
    for (int x = 0; x < a.width; ++x) row[x] *= left + step * static_cast<float>(x);
  }
  shot->surfaces(a) = static_cast<std::uint16_t>(hit.surface + 1);
  return hit.surface;
}

// background: surface that is already rendered
void RoomRenderer::tracePixels(const Tile& tile, int background, Shot* shot) const {
  const Eigen::Matrix3f R_map_camera = shot->T_map_camera.linear();
  RoomRay ray{shot->T_map_camera.translation(), {}};
  for (int y = tile.area.y; y < tile.area.br().y; ++y) {
    for (int x = tile.area.x; x < tile.area.br().x; ++x) {
      if (rayAt(x, y).isZero()) continue;
      ray.direction = R_map_camera * rayAt(x, y);
      const RoomHit hit = scene_->trace(ray, tile.objects);
      if (hit.surface == background) continue;
      const bool fine = hit.detail < kFineDetail * pixel_angle_;
      shot->surfaces(y, x) = static_cast<std::uint16_t>(hit.surface + 1) | (fine ? kFine : std::uint16_t{0});
      shot->light(y, x) = scene_->radiance(ray, hit, hit.distance * pixel_angle_);
    }
  }
}

void RoomRenderer::refineTile(const Tile& tile, const cv::Mat_<std::uint8_t>& edges, Shot* shot) const {
  for (int y = tile.area.y; y < tile.area.br().y; ++y) {
    for (int x = tile.area.x; x < tile.area.br().x; ++x) {
      if (edges(y, x) != 0) shot->light(y, x) = supersample(x, y, *shot, tile.objects);
    }
  }
}

float RoomRenderer::supersample(int x, int y, const Shot& shot, const std::vector<int>& objects) const {
  const Eigen::Vector3f &middle = rayAt(x, y), &left = rayAt(x - 1, y), &right = rayAt(x + 1, y),
                        &above = rayAt(x, y - 1), &below = rayAt(x, y + 1);
  if (middle.isZero() || left.isZero() || right.isZero() || above.isZero() || below.isZero()) return 0.0F;
  Eigen::Matrix3f rays;  // columns: middle, change per pixel to the right, and down
  rays << middle, 0.5F * (right - left), 0.5F * (below - above);
  const Eigen::Matrix3f directions = shot.T_map_camera.linear() * rays;
  RoomRay ray{shot.T_map_camera.translation(), {}};
  float sum = 0.0F;
  for (const Eigen::Vector2f& sample : samples_) {
    ray.direction = directions.col(0) + sample.x() * directions.col(1) + sample.y() * directions.col(2);
    const RoomHit hit = scene_->trace(ray, objects);
    sum +=
        scene_->radiance(ray, hit, hit.distance * pixel_angle_ / static_cast<float>(params_.supersampling));
  }
  return sum / static_cast<float>(samples_.size());
}

cv::Mat RoomRenderer::expose(const cv::Mat_<float>& radiance, std::uint64_t frame) const {
  cv::Mat_<std::uint8_t> image(radiance.size());
  cv::RNG rng((static_cast<std::uint64_t>(params_.seed) << 32U) + frame + 1);
  const float sigma = static_cast<float>(params_.noise_sigma);
  for (int y = 0; y < image.rows; ++y) {
    const float* noise = noise_.data() + rng.uniform(0, std::max(1, kRenderNoise - image.cols));
    const float* light = radiance[y];
    const float* gain = gain_[y];
    std::uint8_t* grey = image[y];
    for (int x = 0; x < image.cols; ++x) {
      grey[x] =
          static_cast<std::uint8_t>(std::clamp(light[x] * gain[x] + sigma * noise[x] + 0.5F, 0.0F, 255.0F));
    }
  }
  return image;
}

}  // namespace sextant
