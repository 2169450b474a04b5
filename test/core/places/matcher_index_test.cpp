// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <stdexcept>

#include "sextant/places/descriptor_index.hpp"
#include "test_descriptors.hpp"
#include "test_refusal.hpp"

namespace sextant {
namespace {

const std::string kBefore = "What is in the file before it.";

std::string content(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

void write(const std::string& path, const std::string& content) {
  std::ofstream(path, std::ios::binary) << content;
}

class StoredIndex : public testing::Test {
 protected:
  void SetUp() override {
    char pattern[] = "/tmp/sextant_index_XXXXXX";
    folder_ = mkdtemp(pattern);
    path_ = folder_ + "/index";
    write(path_, kBefore);
  }
  void TearDown() override { std::filesystem::remove_all(folder_); }

  std::unique_ptr<DescriptorIndex> readBack() const { return readDescriptorIndex(path_, kBefore.size()); }

  std::string readingRefused(int64_t offset) const {
    return refusal<std::runtime_error>([&] { readDescriptorIndex(path_, offset); });
  }

  std::string folder_, path_;
};

const std::vector<MatcherCase>& kinds() {
  static const std::vector<MatcherCase> all = {
      {"faiss", CV_32F, 64},      {"faiss", CV_32F, 128},      {"faiss", CV_8U, 61},
      {"BruteForce", CV_32F, 65}, {"FlannBased", CV_32F, 127}, {"BruteForce-Hamming(2)", CV_8U, 32}};
  return all;
}

class StoredIndexOf : public StoredIndex, public testing::WithParamInterface<MatcherCase> {
 protected:
  void SetUp() override {
    StoredIndex::SetUp();
    all_ = imageDescriptors(30, GetParam().width, GetParam().type);
    queries_ = similarTo(all_);
    index_ = indexOf(GetParam().matcher, all_);
    index_->append(path_);
  }

  void expectSameAs(const DescriptorIndex& other) const {
    EXPECT_EQ(other.size(), index_->size());
    EXPECT_EQ(other.bytes(), index_->bytes());
    expectSame(other.search(queries_, 5), index_->search(queries_, 5));
  }

  Descriptors all_;
  cv::Mat queries_;
  std::unique_ptr<DescriptorIndex> index_;
};

INSTANTIATE_TEST_SUITE_P(Kinds, StoredIndexOf, testing::ValuesIn(kinds()),
                         [](const auto& kind) { return "Wide" + std::to_string(kind.param.width); });

TEST_P(StoredIndexOf, ReadsWhatItWrote) {
  EXPECT_EQ(content(path_).substr(0, kBefore.size()), kBefore);
  std::ofstream(path_, std::ios::binary | std::ios::app) << "What follows it.";
  expectSameAs(*readBack());
  const std::string wide = std::to_string(GetParam().width + 1) + " wide; those of the index are ";
  EXPECT_NE(refusal<std::invalid_argument>([&] {
              readBack()->search(cv::Mat(1, GetParam().width + 1, GetParam().type), 1);
            }).find(wide),
            std::string::npos);
}

TEST_P(StoredIndexOf, ChangesOfAMappedIndexStayInMemory) {
  const std::string stored = content(path_);
  const auto added = readBack(), removed = readBack();
  const cv::Mat more = randomDescriptors(20, GetParam().width, GetParam().type, 500);
  removed->remove(6);
  index_->remove(6);
  expectSameAs(*removed);
  added->add(1000, more);
  added->remove(6);
  added->remove(1000);
  expectSameAs(*added);
  index_->add(1000, more);
  added->add(1000, more);
  expectSameAs(*added);
  EXPECT_EQ(added->search(more, 1).image_ids, std::vector<int32_t>(20, 1000));
  EXPECT_EQ(content(path_), stored);
  EXPECT_EQ(readBack()->size(), together(all_).rows);
}

TEST_P(StoredIndexOf, WritesAMappedIndex) {
  const auto second = std::filesystem::file_size(path_);
  readBack()->append(path_);
  expectSameAs(*readDescriptorIndex(path_, second));
  expectSameAs(*readBack());
}

TEST_P(StoredIndexOf, RejectsATruncatedFile) {
  const std::string whole = content(path_);
  for (const size_t lacking : {size_t{1}, size_t{500}, whole.size() / 2}) {
    write(path_, whole.substr(0, whole.size() - lacking));
    const std::string message = readingRefused(kBefore.size());
    EXPECT_EQ(message.find(path_ + ": the index cannot be read: "), 0) << message;
  }
}

TEST_P(StoredIndexOf, ReportsAFullDisk) {
  const auto few = indexOf(GetParam().matcher, {{0, queries_.rowRange(0, 2)}});
  for (DescriptorIndex* index : {index_.get(), few.get()}) {
    const std::string message = refusal<std::runtime_error>([&] { index->append("/dev/full"); });
    EXPECT_EQ(message.find("/dev/full: cannot be written to"), 0) << message;
  }
}

TEST_F(StoredIndex, RejectsOtherFiles) {
  const std::string reason =
      hasFaiss() ? ": is too short" : ": the index cannot be read: it is not of this version";
  EXPECT_EQ(readingRefused(kBefore.size()), path_ + reason);
  EXPECT_EQ(readingRefused(kBefore.size() + 9), path_ + reason);
  EXPECT_EQ(readingRefused(-1), path_ + reason);
  EXPECT_EQ(readingRefused(0).find(path_ + ": the index cannot be read: "), 0);
  write(path_, "IB, but no index of bits");
  EXPECT_EQ(readingRefused(0).find(path_ + ": the index cannot be read: "), 0);
  const auto index = indexOf("faiss", imageDescriptors(3, 32, CV_8U));
  EXPECT_EQ(refusal<std::runtime_error>([&] { readDescriptorIndex(folder_ + "/none", 0); }),
            folder_ + "/none: cannot be read");
  const std::string message = refusal<std::runtime_error>([&] { index->append(folder_ + "/none/index"); });
  EXPECT_EQ(message.find(folder_ + "/none/index: cannot be written to"), 0) << message;
}

TEST_F(StoredIndex, RejectsADamagedHeaderOfAMatcher) {
  indexOf("BruteForce", imageDescriptors(3, 64, CV_32F))->append(path_);
  const std::string whole = content(path_);
  for (const size_t damaged : {47, 48, 52, 59}) {  // end of the name, type, width, number of rows
    std::string other = whole;
    other[kBefore.size() + damaged] = '\x7f';
    write(path_, other);
    EXPECT_EQ(readingRefused(kBefore.size()), path_ + ": the index cannot be read: it is damaged") << damaged;
  }
}

}  // namespace
}  // namespace sextant
