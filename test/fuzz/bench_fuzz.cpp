// Any bytes as a benchmark result for vpr-bench.
#include "base/json.h"
#include "bench/bench_result.h"
#include "fuzz.h"

void vpr::fuzz::run(std::string_view input) {
  const BenchResult bench = read_bench(memory_file(input));
  const BenchComparison comparison = compare_benches(bench, bench);
  render_table(comparison_table(comparison, 1.2), TableFormat::text);
  to_text(comparison_json(comparison, 1.2));
}
