#include "examples.h"

#include <string>

#include "reference/reference.h"
#include "support.h"

namespace vpr::test {
namespace {

std::vector<std::string> numbers(size_t count) {
  std::vector<std::string> names;
  for (size_t i = 0; i < count; ++i) names.push_back(std::to_string(i));
  return names;
}

size_t window_count(size_t frames, size_t window_length) {
  return frames < window_length ? 0 : frames - window_length + 1;
}

}  // namespace

std::vector<DescribedFrames> Example::spans() const {
  std::vector<DescribedFrames> all;
  for (size_t s = 0; s < train.size(); ++s) all.push_back({train[s], train_unreadable[s]});
  return all;
}

Example make_example(const std::vector<size_t>& train_frames, size_t query_frames, uint64_t seed) {
  Example example;
  for (size_t s = 0; s < train_frames.size(); ++s) {
    example.train.push_back(walk_codes(train_frames[s], seed + s));
    example.train_unreadable.emplace_back();
  }
  example.query = walk_codes(query_frames, seed + 100);
  return example;
}

SequenceDatabase make_database(const std::vector<std::vector<LdbCode>>& sequences) {
  SequenceDatabase database;
  for (const std::vector<LdbCode>& codes : sequences) {
    const std::string name(1, static_cast<char>('a' + database.sequences.size()));
    database.sequences.push_back({{name, codes.size(), numbers(codes.size())}});
    database.descriptors.append(codes);
  }
  return database;
}

DescriptorSet make_query(const std::vector<LdbCode>& codes) {
  DescriptorSet query;
  query.descriptors.append(codes);
  query.sequence.frames = codes.size();
  query.sequence.frame_names = numbers(codes.size());
  return query;
}

std::vector<uint32_t> reference_openable(const DescriptorRows& train, const DescriptorRows& query,
                                         size_t window_length) {
  const size_t rows = window_count(query.size(), window_length);
  const size_t cols = window_count(train.size(), window_length);
  std::vector<uint32_t> distances(rows * cols);
  for (size_t j = 0; j < rows; ++j)
    for (size_t i = 0; i < cols; ++i)
      distances[j * cols + i] = reference_window_distance(train, i, query, j, window_length);
  return distances;
}

std::vector<uint32_t> reference_fastable(const DescriptorRows& train, const DescriptorRows& query,
                                         size_t window_length) {
  const size_t rows = window_count(query.size(), window_length);
  const size_t cols = window_count(train.size(), window_length);
  std::vector<uint32_t> distances(rows * cols);
  for (size_t j = 0; j < rows; ++j) {
    for (size_t i = 0; i < cols; ++i) {
      if (j == 0 || i == 0) {
        distances[j * cols + i] = reference_window_distance(train, i, query, j, window_length);
        continue;
      }
      const size_t last = window_length - 1;
      distances[j * cols + i] = distances[(j - 1) * cols + i - 1] +
                                reference_distance(train, i + last, query, j + last) -
                                reference_distance(train, i - 1, query, j - 1);
    }
  }
  return distances;
}

}  // namespace vpr::test
