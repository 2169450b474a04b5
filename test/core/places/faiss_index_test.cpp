// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#include "faiss_index.hpp"

#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <stdexcept>

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

class FaissIndex : public testing::Test {
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
      {"faiss", CV_32F, 64}, {"faiss", CV_32F, 128}, {"faiss", CV_8U, 61}};
  return all;
}

class FaissIndexOf : public FaissIndex, public testing::WithParamInterface<MatcherCase> {
 protected:
  void SetUp() override {
    FaissIndex::SetUp();
    all_ = pictures(30, GetParam().width, GetParam().type);
    queries_ = similarTo(all_);
    index_ = indexOf("faiss", all_);
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

INSTANTIATE_TEST_SUITE_P(Kinds, FaissIndexOf, testing::ValuesIn(kinds()),
                         [](const auto& kind) { return "Wide" + std::to_string(kind.param.width); });

TEST_P(FaissIndexOf, IsReadAsItWasWritten) {
  EXPECT_EQ(content(path_).substr(0, kBefore.size()), kBefore);
  std::ofstream(path_, std::ios::binary | std::ios::app) << "What follows it.";
  expectSameAs(*readBack());
  const std::string wide = std::to_string(GetParam().width + 1) + " wide; those of the index are ";
  EXPECT_NE(refusal<std::invalid_argument>([&] {
              readBack()->search(cv::Mat(1, GetParam().width + 1, GetParam().type), 1);
            }).find(wide),
            std::string::npos);
}

TEST_P(FaissIndexOf, ChangesOfWhatWasReadStayInMemory) {
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
  EXPECT_EQ(added->search(more, 1).owners, std::vector<int32_t>(20, 1000));
  EXPECT_EQ(content(path_), stored);
  EXPECT_EQ(readBack()->size(), together(all_).rows);
}

TEST_P(FaissIndexOf, WhatWasReadCanBeWrittenAgain) {
  const auto second = std::filesystem::file_size(path_);
  readBack()->append(path_);
  expectSameAs(*readDescriptorIndex(path_, second));
  expectSameAs(*readBack());
}

TEST_P(FaissIndexOf, OneCutShortIsRefused) {
  const std::string whole = content(path_);
  for (const size_t lacking : {size_t{1}, size_t{500}, whole.size() / 2}) {
    write(path_, whole.substr(0, whole.size() - lacking));
    const std::string message = readingRefused(kBefore.size());
    EXPECT_EQ(message.find(path_ + ": no index can be read: "), 0) << message;
  }
}

TEST_P(FaissIndexOf, AFullDiskIsTold) {
  const auto few = indexOf("faiss", {{0, queries_.rowRange(0, 2)}});
  for (DescriptorIndex* index : {index_.get(), few.get()}) {
    const std::string message = refusal<std::runtime_error>([&] { index->append("/dev/full"); });
    EXPECT_EQ(message.find("/dev/full: cannot be written to"), 0) << message;
  }
}

TEST_F(FaissIndex, WhatIsNoneIsRefused) {
  EXPECT_EQ(readingRefused(kBefore.size()), path_ + ": is too short");
  EXPECT_EQ(readingRefused(kBefore.size() + 9), path_ + ": is too short");
  EXPECT_EQ(readingRefused(-1), path_ + ": is too short");
  EXPECT_EQ(readingRefused(0).find(path_ + ": no index can be read: "), 0);
  write(path_, "IB, but no index of bits");
  EXPECT_EQ(readingRefused(0).find(path_ + ": no index can be read: "), 0);
  const auto index = indexOf("faiss", pictures(3, 32, CV_8U));
  EXPECT_EQ(refusal<std::runtime_error>([&] { readDescriptorIndex(folder_ + "/none", 0); }),
            folder_ + "/none: cannot be read");
  EXPECT_EQ(refusal<std::runtime_error>([&] { index->append(folder_ + "/none/index"); }),
            folder_ + "/none/index: cannot be written to");
}

TEST_F(FaissIndex, MatchersOfOpenCvAreNotStored) {
  const auto index = indexOf("BruteForce", pictures(3, 64, CV_32F));
  EXPECT_EQ(refusal<std::runtime_error>([&] { index->append(path_); }),
            path_ + ": OpenCV's matchers cannot be stored");
  EXPECT_EQ(content(path_), kBefore);
}

}  // namespace
}  // namespace sextant
