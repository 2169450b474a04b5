// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#include "faiss_index.hpp"

#include <faiss/IndexBinaryIVF.h>
#include <faiss/IndexIVF.h>
#include <faiss/IndexPreTransform.h>
#include <faiss/impl/FaissException.h>
#include <faiss/impl/IDSelector.h>
#include <faiss/impl/io.h>
#include <faiss/index_factory.h>
#include <faiss/index_io.h>
#include <faiss/invlists/InvertedLists.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <stdexcept>

namespace sextant {
namespace {

using faiss::Index;
using Id = faiss::Index::idx_t;

constexpr int ROW_BITS = 16;         // of an id; the others are its owner's
constexpr int REDUCED_WIDTH = 64;    // of descriptors with more numbers
constexpr int64_t MANY = 2000000;    // descriptors from which on they are stored in half of the bytes
constexpr int POINTS_PER_LIST = 39;  // that k-means wants at least, by faiss
constexpr int PROBES = 8;            // lists that are looked into, at least

Id idOf(int32_t owner, int row) { return (static_cast<Id>(owner) << ROW_BITS) | row; }

int listCount(int64_t expected, int samples) {
  const auto wanted = static_cast<int64_t>(2 * std::sqrt(static_cast<double>(expected)));
  return static_cast<int>(std::clamp<int64_t>(wanted, 1, std::max(1, samples / POINTS_PER_LIST)));
}

int probeCount(size_t lists) { return std::max(PROBES, static_cast<int>(lists / 64)); }

std::string description(int width, int samples, int64_t expected) {
  const bool reduce = width > REDUCED_WIDTH && samples >= 10 * width;
  const std::string codes = reduce && expected >= MANY ? "PQ32" : "SQ8";
  return (reduce ? "PCA" + std::to_string(REDUCED_WIDTH) + "," : std::string()) + "IVF" +
         std::to_string(listCount(expected, samples)) + "," + codes;
}

/// What float and binary indexes differ in, and faiss has no common base for.
struct Floats {
  using Base = Index;
  using Lists = faiss::IndexIVF;
  using Value = float;
  using Distance = float;
  static constexpr int TYPE = CV_32F;

  static std::unique_ptr<Base> make(const cv::Mat& samples, int64_t expected) {
    const std::string text = description(samples.cols, samples.rows, expected);
    return std::unique_ptr<Base>(faiss::index_factory(samples.cols, text.c_str()));
  }
  static Lists* lists(Base* index) {
    if (auto* reduced = dynamic_cast<faiss::IndexPreTransform*>(index)) index = reduced->index;
    return dynamic_cast<Lists*>(index);
  }
  static int width(const Base& index) { return static_cast<int>(index.d); }
  static float distance(Distance squared) { return std::sqrt(std::max(squared, 0.0F)); }
  static Base* read(faiss::IOReader* reader) { return faiss::read_index(reader, faiss::IO_FLAG_MMAP); }
  static void write(const Base* index, faiss::IOWriter* writer) { faiss::write_index(index, writer); }
};

struct Bits {
  using Base = faiss::IndexBinary;
  using Lists = faiss::IndexBinaryIVF;
  using Value = uint8_t;
  using Distance = int32_t;
  static constexpr int TYPE = CV_8U;

  static std::unique_ptr<Base> make(const cv::Mat& samples, int64_t expected) {
    const std::string text = "BIVF" + std::to_string(listCount(expected, samples.rows));
    return std::unique_ptr<Base>(faiss::index_binary_factory(8 * samples.cols, text.c_str()));
  }
  static Lists* lists(Base* index) { return dynamic_cast<Lists*>(index); }
  static int width(const Base& index) { return index.d / 8; }
  static float distance(Distance distance) { return static_cast<float>(distance); }
  static Base* read(faiss::IOReader* reader) { return faiss::read_index_binary(reader, faiss::IO_FLAG_MMAP); }
  static void write(const Base* index, faiss::IOWriter* writer) { faiss::write_index_binary(index, writer); }
};

template <class Kind>
class FaissIndex : public DescriptorIndex {
 public:
  using Base = typename Kind::Base;

  FaissIndex(const cv::Mat& samples, int64_t expected) : index_(Kind::make(samples, expected)) {
    lists().cp.min_points_per_centroid = 1;  // few pictures make few points: no reason for a warning
    index_->train(samples.rows, values(samples));
    lists().nprobe = probeCount(lists().nlist);
  }

  explicit FaissIndex(std::unique_ptr<Base> index) : index_(std::move(index)), mapped_(true) {
    if (!Kind::lists(index_.get())) throw std::runtime_error("no inverted lists in it");
    lists().nprobe = probeCount(lists().nlist);
  }

  void add(int32_t owner, const cv::Mat& descriptors) override {
    if (owner < 0) throw std::invalid_argument("DescriptorIndex: an owner is 0 or above");
    if (descriptors.rows > 1 << ROW_BITS) throw std::invalid_argument("DescriptorIndex: over 65536 rows");
    if (descriptors.empty()) return;
    const cv::Mat checked = continuous(descriptors);
    std::vector<Id> ids(descriptors.rows);
    for (int row = 0; row < descriptors.rows; ++row) ids[row] = idOf(owner, row);
    ownLists();
    index_->add_with_ids(checked.rows, values(checked), ids.data());
  }

  void remove(int32_t owner) override {
    ownLists();
    index_->remove_ids(faiss::IDSelectorRange(idOf(owner, 0), idOf(owner + 1, 0)));
  }

  Neighbours search(const cv::Mat& descriptors, int k) const override {
    if (k < 1) throw std::invalid_argument("DescriptorIndex: k is 1 or above");
    const size_t count = static_cast<size_t>(descriptors.rows) * k;
    Neighbours found{k, std::vector<float>(count), std::vector<int32_t>(count), std::vector<int32_t>(count)};
    if (descriptors.empty()) return found;
    const cv::Mat checked = continuous(descriptors);
    std::vector<typename Kind::Distance> distances(count);
    std::vector<Id> ids(count);
    index_->search(checked.rows, values(checked), k, distances.data(), ids.data());
    for (size_t i = 0; i < count; ++i) {
      found.distances[i] = Kind::distance(distances[i]);
      found.owners[i] = ids[i] < 0 ? -1 : static_cast<int32_t>(ids[i] >> ROW_BITS);
      found.rows[i] = ids[i] < 0 ? -1 : static_cast<int32_t>(ids[i] & ((1 << ROW_BITS) - 1));
    }
    return found;
  }

  int64_t size() const override { return index_->ntotal; }

  int64_t bytes() const override {
    const auto& all = *Kind::lists(index_.get());
    return index_->ntotal * static_cast<int64_t>(all.code_size + sizeof(Id)) +
           static_cast<int64_t>(all.nlist * Kind::width(*index_) * sizeof(typename Kind::Value));
  }

  void append(const std::string& path) const override {
    std::unique_ptr<FILE, int (*)(FILE*)> file(std::fopen(path.c_str(), "ab"), std::fclose);
    if (!file) throw std::runtime_error(path + ": cannot be written to");
    faiss::FileIOWriter writer(file.get());
    try {
      Kind::write(index_.get(), &writer);
    } catch (const faiss::FaissException& error) {
      throw std::runtime_error(path + ": cannot be written to: " + error.what());
    }
    if (std::fflush(file.get())) throw std::runtime_error(path + ": cannot be written to");
  }

 private:
  static const typename Kind::Value* values(const cv::Mat& matrix) {
    return matrix.ptr<typename Kind::Value>();
  }

  typename Kind::Lists& lists() { return *Kind::lists(index_.get()); }

  cv::Mat continuous(const cv::Mat& descriptors) const {
    if (descriptors.type() != Kind::TYPE || descriptors.cols != Kind::width(*index_))
      throw std::invalid_argument("DescriptorIndex: descriptors of another kind than the index has");
    return descriptors.isContinuous() ? descriptors : descriptors.clone();
  }

  /// What lies in a file cannot be changed there.
  void ownLists() {
    if (!mapped_) return;
    const faiss::InvertedLists& old = *lists().invlists;
    auto copy = std::make_unique<faiss::ArrayInvertedLists>(old.nlist, old.code_size);
    for (size_t list = 0; list < old.nlist; ++list) {
      faiss::InvertedLists::ScopedIds ids(&old, list);
      faiss::InvertedLists::ScopedCodes codes(&old, list);
      copy->add_entries(list, old.list_size(list), ids.get(), codes.get());
    }
    lists().replace_invlists(copy.release(), true);
    mapped_ = false;
  }

  std::unique_ptr<Base> index_;
  bool mapped_ = false;
};

template <class Kind>
std::unique_ptr<DescriptorIndex> readKind(FILE* file) {
  faiss::FileIOReader reader(file);
  return std::make_unique<FaissIndex<Kind>>(std::unique_ptr<typename Kind::Base>(Kind::read(&reader)));
}

}  // namespace

std::unique_ptr<DescriptorIndex> makeFaissIndex(const cv::Mat& samples, int64_t expected) {
  if (samples.type() == CV_8U) return std::make_unique<FaissIndex<Bits>>(samples, expected);
  return std::make_unique<FaissIndex<Floats>>(samples, expected);
}

std::unique_ptr<DescriptorIndex> readFaissIndex(const std::string& path, int64_t offset) {
  std::unique_ptr<FILE, int (*)(FILE*)> file(std::fopen(path.c_str(), "rb"), std::fclose);
  if (!file) throw std::runtime_error(path + ": cannot be read");
  char begin[2] = {};
  if (std::fseek(file.get(), offset, SEEK_SET) || std::fread(begin, 1, 2, file.get()) != 2 ||
      std::fseek(file.get(), offset, SEEK_SET))
    throw std::runtime_error(path + ": is too short");
  try {
    return begin[0] == 'I' && begin[1] == 'B' ? readKind<Bits>(file.get()) : readKind<Floats>(file.get());
  } catch (const std::exception& error) {
    throw std::runtime_error(path + ": no index can be read: " + error.what());
  }
}

}  // namespace sextant
