// OpenFABMAP's own run on a corridor walked twice: its files as input, its posteriors as output.
#include <algorithm>
#include <cmath>

#include <catch2/catch.hpp>

#include "fabmap/model.h"
#include "fabmap/place_query.h"
#include "fabmap/word_training.h"
#include "printed.h"
#include "reference/reference_words.h"

using namespace vpr;
using namespace vpr::test;

namespace {

struct Loop {
  ChowLiuTree tree;
  std::vector<WordSet> pretrain;
  std::vector<WordSet> frames;
  ViewWords places;  // frames 0 to 39

  explicit Loop(const std::filesystem::path& folder) {
    const TemporaryFolder arrays;
    const auto converted = [&](const std::string& name) {
      run_ok(source_path("scripts/convert/openfabmap.py"),
             {folder / (name + ".yml.gz"), "-o", arrays / (name + ".npy")});
      return arrays / (name + ".npy");
    };
    tree = read_openfabmap_tree(converted("tree"));
    pretrain = read_openfabmap_frames({converted("bow-pretrain"), {}}, tree.words());
    frames = read_openfabmap_frames({converted("bow-loop"), {}}, tree.words());
    for (size_t f = 0; f < 40; ++f) places.add(frames[f]);
  }
};

// The largest difference of any posterior of frames 40 to 79 from the expected file.
double largest_difference(const Loop& loop, const std::filesystem::path& expected,
                          const char* variant, WordModel words, bool pretrain_new_place) {
  const auto wanted = read_array<double>(expected);
  const FabmapModel model = make_fabmap_model(loop.tree, {}, words);
  const WordIndex index_lists = make_word_index(loop.places, model.words());
  const FabmapIndex index = make_fabmap_index(model, loop.places, index_lists);
  ViewWords samples;
  for (const WordSet& frame : loop.pretrain) samples.add(frame);
  const WordIndex sample_index_lists = make_word_index(samples, model.words());
  const FabmapIndex sample_index = make_fabmap_index(model, samples, sample_index_lists);
  double largest = 0;
  for (size_t f = 0; f < 40; ++f) {
    const WordSet& frame = loop.frames[40 + f];
    const auto views = find_fabmap_variant(variant).log_likelihoods(
        {model, loop.places, index, frame, loop.places.views()});
    const double new_place = pretrain_new_place
                                 ? log_mean_exp(fabmap1_log_likelihoods(
                                       {model, samples, sample_index, frame, samples.views()}))
                                 : new_place_mean_field(model, frame);
    const auto posterior = fabmap_posterior(views, new_place, {}, {});
    for (size_t i = 0; i < posterior.size(); ++i)
      largest = std::max(largest, std::abs(posterior[i] - wanted[f * 41 + i]));
  }
  return largest;
}

}  // namespace

TEST_CASE("posteriors on the loop equal OpenFABMAP's to 1e-9") {
  const auto folder = real_data("expected/fabmap-loop");
  if (!folder) return;
  const Loop loop(*folder);
  for (const char* variant : {"fabmap1", "fabmap2"}) {
    INFO(variant);
    CHECK(largest_difference(loop, *folder / "fabmap1-tree-meanfield.npy", variant, WordModel::tree,
                             false) < 1e-9);
    CHECK(largest_difference(loop, *folder / "fabmap1-naive-meanfield.npy", variant,
                             WordModel::naive_bayes, false) < 1e-9);
    CHECK(largest_difference(loop, *folder / "fabmap2-tree-pretrain.npy", variant, WordModel::tree,
                             true) < 1e-9);
  }
}

TEST_CASE(
    "the tree of OpenFABMAP's words is a maximum spanning tree of ours, with its conditionals") {
  const auto folder = real_data("expected/fabmap-loop");
  if (!folder) return;
  const Loop loop(*folder);
  const ChowLiuTree ours = train_chow_liu(loop.pretrain, loop.tree.words(), {});
  CHECK(ours.parent == reference_chow_liu(loop.pretrain, loop.tree.words()).parent);
  for (size_t q = 0; q < ours.words(); ++q)
    REQUIRE(ours.p[q] == Approx(loop.tree.p[q]).margin(1e-12));
}

// Counts depend on the seed of k-means; docs/benchmarks/why-these-defaults.md has others.
TEST_CASE("our own vocabulary recognizes the second lap") {
  const auto tower = real_data("data/tower");
  const auto loop = real_data("data/loop");
  if (!tower || !loop) return;
  Words train = {"fabmap", "--features", "sift", "--words", "500", "--quiet", "--train"};
  train.insert(train.end(), {*loop / "images@0:40", "-o", "loop.vprdb"});
  for (const char* floor : {"floor5", "floor7", "floor9", "floor12"})
    train.insert(train.end(), {"--pretrain", *tower / floor});
  run_ok("vpr-train", train);
  run_ok("vpr-query", {"loop.vprdb", "--query", (*loop / "images@40:80").string(), "--t-p", "0.6",
                       "--quiet", "-o", "r.json"});
  const Json report = printed_json(
      "vpr-eval", {"r.json", "--ground-truth", (*loop / "ground_truth.csv").string(), "--json"});
  CHECK(report["best_match"]["correct"].get<int>() >= 34);
  CHECK(report["counts"]["pairs"]["correct"].get<int>() >= 31);
  CHECK(report["counts"]["pairs"]["incorrect"].get<int>() <= 6);
}

// Frame 5 of the second lap (46.jpg) shows no word. Its posterior for the training frames without
// words is above 0.6, which was the only incorrect recognition at t_p 0.6 (34 correct, 1
// incorrect); a frame without words is not recognized.
TEST_CASE("with OpenFABMAP's words, every recognition of the second lap is correct") {
  const auto folder = real_data("expected/fabmap-loop");
  if (!folder) return;
  const Loop loop(*folder);
  FabmapDatabase database;
  database.tree = loop.tree;
  for (const WordSet& frame : loop.pretrain) database.pretrain.add(frame);
  add_group(database, {{"lap", 40, Words(40)}}, std::span(loop.frames).subspan(0, 40));
  index_views(database);
  SequenceWords query;
  query.words.assign(loop.frames.begin() + 40, loop.frames.begin() + 80);
  query.sequence.frames = query.words.size();
  REQUIRE(query.words[5].empty());
  FabmapQuerySettings settings;
  settings.place_threshold = 0.6;
  double of_frame_5 = 0;
  const Result result =
      query_fabmap(database, query, "q", settings, 1,
                   [&](size_t frame, std::span<const double> posterior) {
                     if (frame == 5)
                       of_frame_5 = *std::max_element(posterior.begin() + 1, posterior.end());
                   },
                   {})
          .result;
  CHECK(of_frame_5 > 0.6);
  CHECK(result.recognitions.size() == 34);
  CHECK_FALSE(result.best[5]);
  for (const Match& recognition : result.recognitions) {
    INFO("frame " << recognition.query << ", place " << recognition.train);
    CHECK(recognition.query != 5);
    CHECK(std::abs(static_cast<int>(recognition.query) - static_cast<int>(recognition.train)) <= 3);
  }
}
