// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#ifdef SEXTANT_FAISS
#include "faiss_index.hpp"

#include <faiss/IndexBinaryIVF.h>
#include <faiss/IndexIVF.h>
#include <faiss/IndexIVFPQ.h>
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
#include <numeric>
#include <stdexcept>

namespace sextant {
namespace {

using faiss::Index;
using Id = decltype(faiss::Index::ntotal);  // faiss::Index::idx_t, later faiss::idx_t

constexpr int kReducedWidth = 64;       // PCA reduces wider descriptors to it
constexpr int kSamplesPerColumn = 10;   // minimum for training the PCA
constexpr int64_t kMany = 2000000;      // descriptors, from which on product quantization halves their memory
constexpr int kPointsPerCentroid = 39;  // minimum that faiss recommends for k-means
constexpr int kProbes = 8;              // inverted lists that are searched for a descriptor
constexpr int kIterations = 10, kIterationsIfMany = 4;  // of k-means

Id firstId(Id image_id) { return image_id * DescriptorIndex::kMaxRows; }

int listCount(int64_t expected, int samples) {
  const auto wanted = static_cast<int64_t>(2 * std::sqrt(static_cast<double>(expected)));
  return static_cast<int>(std::clamp<int64_t>(wanted, 1, std::max(1, samples / kPointsPerCentroid)));
}

std::string description(int width, int samples, int64_t expected) {
  std::string lists = "IVF" + std::to_string(listCount(expected, samples));
  if (samples < kSamplesPerColumn * width) return lists + ",SQ8";
  if (width > kReducedWidth) lists = "PCA" + std::to_string(kReducedWidth) + "," + lists;
  // Without polysemous codes, whose training takes minutes and which no search here uses.
  const bool is_divisible = width >= kReducedWidth;
  return lists + (expected < kMany || !is_divisible ? ",SQ8" : "_HNSW32,PQ32np");
}

/// The precomputed tables take more memory than the lists.
void disablePrecomputedTables(Index* lists) {
  if (auto* products = dynamic_cast<faiss::IndexIVFPQ*>(lists)) products->use_precomputed_table = -1;
}

/// Traits of real-valued indexes; faiss has no common base of these and binary ones.
struct Floats {
  using Base = Index;
  using Lists = faiss::IndexIVF;
  using Value = float;
  using Distance = float;
  static constexpr int kType = CV_32F;

  static std::unique_ptr<Base> make(const cv::Mat& samples, int64_t expected) {
    const std::string text = description(samples.cols, samples.rows, expected);
    std::unique_ptr<Base> index(faiss::index_factory(samples.cols, text.c_str()));
    disablePrecomputedTables(lists(index.get()));
    return index;
  }
  static Lists* lists(Base* index) {
    if (auto* reduced = dynamic_cast<faiss::IndexPreTransform*>(index)) index = reduced->index;
    return dynamic_cast<Lists*>(index);
  }
  static int width(const Base& index) { return static_cast<int>(index.d); }
  static float distance(Distance squared) { return std::sqrt(std::max(squared, 0.0F)); }
  static constexpr int kReading = faiss::IO_FLAG_MMAP | faiss::IO_FLAG_SKIP_PRECOMPUTE_TABLE;
  static Base* read(faiss::IOReader* reader) { return faiss::read_index(reader, kReading); }
  static void write(const Base* index, faiss::IOWriter* writer) { faiss::write_index(index, writer); }
};

/// Traits of binary indexes.
struct Bits {
  using Base = faiss::IndexBinary;
  using Lists = faiss::IndexBinaryIVF;
  using Value = uint8_t;
  using Distance = int32_t;
  static constexpr int kType = CV_8U;

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

/// Index by faiss' inverted files.
template <class Kind>
class FaissIndex : public DescriptorIndex {
 public:
  using Base = typename Kind::Base;

  /// @param samples not empty, continuous
  FaissIndex(const cv::Mat& samples, int64_t expected)
      : DescriptorIndex(Kind::kType, samples.cols), index_(Kind::make(samples, expected)) {
    lists().cp.min_points_per_centroid = 1;  // no warning for small maps
    lists().cp.niter = expected < kMany ? kIterations : kIterationsIfMany;
    index_->train(samples.rows, values(samples));
    lists().nprobe = kProbes;
  }

  /// @param index not null; as read by faiss, with memory-mapped lists
  explicit FaissIndex(std::unique_ptr<Base> index)
      : DescriptorIndex(Kind::kType, Kind::width(*index)), index_(std::move(index)), mapped_(true) {
    if (!Kind::lists(index_.get())) throw std::runtime_error("it has no inverted lists");
    lists().nprobe = kProbes;
  }

  void remove(int32_t image_id) override {
    ownLists();
    index_->remove_ids(faiss::IDSelectorRange(firstId(image_id), firstId(Id{image_id} + 1)));
  }

  int64_t size() const override { return index_->ntotal; }

  int64_t bytes() const override {
    const auto& all = *Kind::lists(index_.get());
    return index_->ntotal * static_cast<int64_t>(all.code_size + sizeof(Id)) +
           static_cast<int64_t>(all.nlist * Kind::width(all) * sizeof(typename Kind::Value));
  }

  void append(const std::string& path) override {
    ownLists();  // faiss writes the file name of mapped lists instead of their content
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

  void addChecked(int32_t image_id, const cv::Mat& descriptors) override {
    std::vector<Id> ids(descriptors.rows);
    std::iota(ids.begin(), ids.end(), firstId(image_id));
    ownLists();
    index_->add_with_ids(descriptors.rows, values(descriptors), ids.data());
  }

  void searchChecked(const cv::Mat& descriptors, Neighbours& found) const override {
    const size_t count = found.image_ids.size();
    std::vector<typename Kind::Distance> distances(count);
    std::vector<Id> ids(count);
    index_->search(descriptors.rows, values(descriptors), found.k, distances.data(), ids.data());
    for (size_t i = 0; i < count; ++i) {
      if (ids[i] < 0) continue;
      found.distances[i] = Kind::distance(distances[i]);
      found.image_ids[i] = static_cast<int32_t>(ids[i] / kMaxRows);
      found.rows[i] = static_cast<int32_t>(ids[i] % kMaxRows);
    }
  }

  /// Copies mapped lists into memory: mapped ones are read-only.
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
  auto index = std::make_unique<FaissIndex<Kind>>(std::unique_ptr<typename Kind::Base>(Kind::read(&reader)));
  // faiss maps lists without checking the file's size; a search beyond its end would crash the process.
  const long end = std::ftell(file);
  if (std::fseek(file, 0, SEEK_END) || std::ftell(file) < end) throw std::runtime_error("it is truncated");
  return index;
}

}  // namespace

std::unique_ptr<DescriptorIndex> makeFaissIndex(const cv::Mat& samples, int64_t expected) {
  if (samples.type() == CV_8U) return std::make_unique<FaissIndex<Bits>>(samples, expected);
  return std::make_unique<FaissIndex<Floats>>(samples, expected);
}

std::unique_ptr<DescriptorIndex> readFaissIndex(const std::string& path, int64_t offset) {
  std::unique_ptr<FILE, int (*)(FILE*)> file(std::fopen(path.c_str(), "rb"), std::fclose);
  if (!file) throw std::runtime_error(path + ": cannot be read");
  char begin[2] = {};  // faiss' type code: that of binary indexes begins with IB
  if (std::fseek(file.get(), offset, SEEK_SET) || std::fread(begin, 1, 2, file.get()) != 2 ||
      std::fseek(file.get(), offset, SEEK_SET))
    throw std::runtime_error(path + ": is too short");
  try {
    return begin[0] == 'I' && begin[1] == 'B' ? readKind<Bits>(file.get()) : readKind<Floats>(file.get());
  } catch (const std::exception& error) {
    throw std::runtime_error(path + ": the index cannot be read: " + error.what());
  }
}

}  // namespace sextant
#endif  // SEXTANT_FAISS
