// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#include "matcher_index.hpp"

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <mutex>
#include <opencv2/features2d.hpp>
#include <stdexcept>

namespace sextant {
namespace {

constexpr int kMaxChunk = 1 << 17;  // rows per matrix; OpenCV's brute force takes fewer than 1 << 18

constexpr char kMagic[16] = "SEXTANT MATCHER";

using File = std::unique_ptr<FILE, int (*)(FILE*)>;

/// What a stored index begins with; then its rows and their descriptors.
struct Header {
  char magic[16], matcher[32];
  int32_t type, width, rows;
};

/// Where a descriptor is from.
struct Row {
  int32_t image_id, row;
};

/// Seeds OpenCV's random numbers in this thread for its lifetime.
class FixedSeed {
 public:
  FixedSeed() : before_(cv::theRNG()) { cv::theRNG() = cv::RNG(kSeed); }
  ~FixedSeed() { cv::theRNG() = before_; }
  FixedSeed(const FixedSeed&) = delete;
  FixedSeed& operator=(const FixedSeed&) = delete;

 private:
  static constexpr uint64_t kSeed = 1;
  cv::RNG before_;
};

/// Index by one of OpenCV's matchers, over the unmodified descriptors.
class MatcherIndex : public DescriptorIndex {
 public:
  MatcherIndex(const std::string& matcher, int type, int width)
      : DescriptorIndex(type, width),
        name_(matcher),
        matcher_(cv::DescriptorMatcher::create(matcher)),
        descriptors_(0, width, type) {}

  /// @param file at the rows and descriptors of this header
  MatcherIndex(const Header& header, FILE* file) : MatcherIndex(header.matcher, header.type, header.width) {
    rows_.resize(header.rows);
    descriptors_.create(header.rows, header.width, header.type);
    if (std::fread(rows_.data(), sizeof(Row), rows_.size(), file) != rows_.size() ||
        std::fread(descriptors_.data, descriptors_.elemSize(), descriptors_.total(), file) !=
            descriptors_.total())
      throw std::runtime_error("it is truncated");
  }

  void remove(int32_t image_id) override {
    const auto is_of_image = [image_id](const Row& row) { return row.image_id == image_id; };
    const auto begin = std::find_if(rows_.begin(), rows_.end(), is_of_image);
    const auto end = std::find_if_not(begin, rows_.end(), is_of_image);
    if (begin == end) return;
    cv::Mat kept = descriptors_.rowRange(0, static_cast<int>(begin - rows_.begin())).clone();
    kept.push_back(descriptors_.rowRange(static_cast<int>(end - rows_.begin()), descriptors_.rows));
    rows_.erase(begin, end);
    descriptors_ = kept;
    trained_ = false;
  }

  int64_t size() const override { return static_cast<int64_t>(rows_.size()); }

  int64_t bytes() const override {
    return static_cast<int64_t>(descriptors_.total() * descriptors_.elemSize() + rows_.size() * sizeof(Row));
  }

  void append(const std::string& path) override {
    const File file(std::fopen(path.c_str(), "ab"), std::fclose);
    Header header{{}, {}, descriptors_.type(), descriptors_.cols, descriptors_.rows};
    std::copy(std::begin(kMagic), std::end(kMagic), header.magic);
    name_.copy(header.matcher, sizeof(header.matcher) - 1);
    if (!file || std::fwrite(&header, sizeof(header), 1, file.get()) != 1 ||
        std::fwrite(rows_.data(), sizeof(Row), rows_.size(), file.get()) != rows_.size() ||
        std::fwrite(descriptors_.data, descriptors_.elemSize(), descriptors_.total(), file.get()) !=
            descriptors_.total() ||
        std::fflush(file.get()))
      throw std::runtime_error(path + ": cannot be written to: " + std::strerror(errno));
  }

 private:
  void addChecked(int32_t image_id, const cv::Mat& descriptors) override {
    descriptors_.push_back(descriptors);
    for (int row = 0; row < descriptors.rows; ++row) rows_.push_back({image_id, row});
    trained_ = false;
  }

  void searchChecked(const cv::Mat& descriptors, Neighbours& found) const override {
    const std::lock_guard<std::mutex> lock(mutex_);  // OpenCV's matchers are trained by the first search
    if (rows_.empty()) return;
    train();
    std::vector<std::vector<cv::DMatch>> matches;
    matcher_->knnMatch(descriptors, matches, std::min(found.k, descriptors_.rows));
    for (const auto& neighbours : matches)
      for (size_t i = 0; i < neighbours.size(); ++i) {
        const size_t at = static_cast<size_t>(neighbours[i].queryIdx) * found.k + i;
        const Row& row = rows_[chunkBegin(neighbours[i].imgIdx) + neighbours[i].trainIdx];
        found.distances[at] = neighbours[i].distance;
        found.image_ids[at] = row.image_id;
        found.rows[at] = row.row;
      }
  }

  void train() const {
    if (trained_) return;
    matcher_->clear();
    for (int chunk = 0; chunk < chunks(); ++chunk)
      matcher_->add(std::vector<cv::Mat>{descriptors_.rowRange(chunkBegin(chunk), chunkBegin(chunk + 1))});
    const FixedSeed reproducible;  // FLANN's trees are random
    matcher_->train();
    trained_ = true;
  }

  // OpenCV's brute force returns wrong matches if one of several matrices has fewer than k rows: chunks of
  // equal size instead of one matrix per image.
  int chunks() const { return 1 + (descriptors_.rows - 1) / kMaxChunk; }
  int chunkBegin(int chunk) const {
    return static_cast<int>(static_cast<int64_t>(descriptors_.rows) * chunk / chunks());
  }

  std::string name_;
  cv::Ptr<cv::DescriptorMatcher> matcher_;
  cv::Mat descriptors_;
  std::vector<Row> rows_;  // of descriptors_; those of one image are contiguous
  mutable bool trained_ = false;
  mutable std::mutex mutex_;
};

// Whether the header is of an index whose descriptors are in the file.
bool isValid(Header& header, int64_t following) {
  if (header.matcher[sizeof(header.matcher) - 1] || header.rows < 0 || header.width < 1) return false;
  if (header.type != CV_8U && header.type != CV_32F) return false;
  const auto bytes = static_cast<int64_t>(sizeof(Row)) + int64_t{header.width} * CV_ELEM_SIZE(header.type);
  return header.rows <= following / bytes;
}

}  // namespace

std::unique_ptr<DescriptorIndex> makeMatcherIndex(const std::string& matcher, int type, int width) {
  return std::make_unique<MatcherIndex>(matcher, type, width);
}

std::unique_ptr<DescriptorIndex> readMatcherIndex(const std::string& path, int64_t offset) {
  const File file(std::fopen(path.c_str(), "rb"), std::fclose);
  if (!file) throw std::runtime_error(path + ": cannot be read");
  Header header;
  if (std::fseek(file.get(), 0, SEEK_END)) throw std::runtime_error(path + ": cannot be read");
  const int64_t end = std::ftell(file.get());
  if (std::fseek(file.get(), offset, SEEK_SET) || std::fread(&header, sizeof(header), 1, file.get()) != 1 ||
      !std::equal(std::begin(kMagic), std::end(kMagic), header.magic))
    return nullptr;
  const int64_t following = end - offset - static_cast<int64_t>(sizeof(header));
  if (!isValid(header, following))
    throw std::runtime_error(path + ": the index cannot be read: it is damaged");
  try {
    return std::make_unique<MatcherIndex>(header, file.get());
  } catch (const std::exception& error) {
    throw std::runtime_error(path + ": the index cannot be read: " + error.what());
  }
}

}  // namespace sextant
