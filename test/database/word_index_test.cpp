#include "database/word_index.h"

#include <catch2/catch.hpp>

#include "base/random.h"

using namespace vpr;

TEST_CASE("an index lists the views of each word, worked out by hand") {
  ViewWords views;
  views.add(std::vector<uint32_t>{0, 2});
  views.add(std::vector<uint32_t>{});
  views.add(std::vector<uint32_t>{2});
  const WordIndex index = make_word_index(views, 3);
  CHECK(index.offsets == std::vector<uint64_t>{0, 1, 1, 3});
  CHECK(index.lists == std::vector<uint16_t>{0, 0, 2});
  CHECK(is_sound(index));
}

TEST_CASE("views beyond a block are listed within theirs") {
  RandomEngine engine(1);
  ViewWords views;
  for (size_t v = 0; v < 2 * kIndexBlock + 3; ++v)
    views.add(std::vector<uint32_t>{static_cast<uint32_t>(uniform_below(engine, 5))});
  const WordIndex index = make_word_index(views, 5);
  REQUIRE(is_sound(index));
  size_t listed = 0;
  for (size_t block = 0; block < 3; ++block) {
    for (uint32_t word = 0; word < 5; ++word) {
      for (const uint16_t v : index.list(block, word)) {
        REQUIRE(views.view(block * kIndexBlock + v)[0] == word);
        ++listed;
      }
    }
  }
  CHECK(listed == views.views());
}

TEST_CASE("an index that leads out of its views is not sound") {
  ViewWords views;
  views.add(std::vector<uint32_t>{0, 1});
  views.add(std::vector<uint32_t>{1});
  const WordIndex good = make_word_index(views, 2);
  REQUIRE(is_sound(good));
  WordIndex bad = good;
  bad.lists[0] = 2;
  CHECK(!is_sound(bad));
  bad = good;
  std::swap(bad.lists[1], bad.lists[2]);
  CHECK(!is_sound(bad));
  bad = good;
  bad.offsets[1] = 1'000'000;
  CHECK(!is_sound(bad));
  bad = good;
  bad.offsets.pop_back();
  CHECK(!is_sound(bad));
  bad = good;
  bad.offsets.back() += 1;
  CHECK(!is_sound(bad));
}
