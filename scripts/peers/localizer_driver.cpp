// Runs the graph search of ovysotska/image_sequence_localizer on a similarity matrix.
//
//   DRIVER SIMILARITIES ROWS COLUMNS FAN_OUT EXPANSION_RATE THRESHOLD OUT
//
// SIMILARITIES: query x reference, float64. OUT: lines "query reference real". Prints the seconds
// of the search.
#include <chrono>
#include <cstdio>
#include <fstream>
#include <iostream>
#include <string>
#include <vector>

#include <glog/logging.h>

#include "database/idatabase.h"
#include "online_localizer/online_localizer.h"
#include "relocalizers/default_relocalizer.h"
#include "successor_manager/successor_manager.h"

namespace {

struct Matrix : localization::database::iDatabase {
  std::vector<double> values;
  int columns = 0;
  int refSize() override { return columns; }
  // Cost 1 / similarity, as its SimilarityMatrix; similarities are above 0.
  double getCost(int query, int reference) override {
    return 1 / values[static_cast<size_t>(query) * columns + reference];
  }
};

}  // namespace

int main(int, char** argv) {
  google::InitGoogleLogging(argv[0]);
  FLAGS_minloglevel = google::GLOG_ERROR;
  FLAGS_logtostderr = true;
  if (std::freopen("/dev/null", "w", stdout) == nullptr) return 1;  // it prints every candidate
  const int rows = std::stoi(argv[2]), columns = std::stoi(argv[3]), fan_out = std::stoi(argv[4]);
  Matrix matrix;
  matrix.columns = columns;
  matrix.values.resize(static_cast<size_t>(rows) * columns);
  std::ifstream(argv[1], std::ios::binary)
      .read(reinterpret_cast<char*>(matrix.values.data()),
            static_cast<long>(matrix.values.size()) * 8);
  localization::relocalizers::DefaultRelocalizer relocalizer(fan_out, columns);
  localization::successor_manager::SuccessorManager successors(&matrix, &relocalizer, fan_out);
  const auto start = std::chrono::steady_clock::now();
  localization::online_localizer::OnlineLocalizer localizer(&successors, std::stod(argv[5]),
                                                            std::stod(argv[6]));
  const auto matches = localizer.findMatchesTill(rows);
  std::cerr << std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count()
            << "\n";
  std::ofstream out(argv[7]);
  for (const auto& match : matches)
    out << match.quId << " " << match.refId << " "
        << (match.state == localization::online_localizer::REAL) << "\n";
}
