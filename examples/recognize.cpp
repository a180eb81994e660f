// Recognizes the places of one image folder in another, and evaluates the matches:
//   recognize TRAIN QUERY GROUND-TRUTH
#include <cstdio>
#include <iostream>

#include <vpr/vpr.h>

int main(int argc, char** argv) {
  if (argc != 4) {
    std::cerr << "recognize TRAIN QUERY GROUND-TRUTH\n";
    return 2;
  }
  try {
    const vpr::Database database = vpr::train({argv[1]});
    const vpr::Result result = vpr::query(database, argv[2]);
    for (const vpr::Match& match : result.recognitions())
      std::printf("query frame %zu: frame %zu of %s, score %.3f, margin %.3f\n", match.query,
                  match.frame, match.sequence.c_str(), match.score, match.margin.value_or(0));
    const vpr::Evaluation evaluation = vpr::evaluate(result, argv[3], {{"tolerance", 2}});
    std::cout << evaluation.summary << "\n"
              << evaluation.correct << " of " << evaluation.frames_with_match << " frames correct, "
              << evaluation.incorrect << " incorrect, R@1 " << evaluation.recall_at_1.value_or(0)
              << "\n";
  } catch (const vpr::Error& error) {
    std::cerr << "recognize: " << error.what() << "\n";
    return 1;
  }
}
