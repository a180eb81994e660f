#include <cmath>
#include <ctime>

#include "base/error.h"
#include "base/stopwatch.h"
#include "bench/benches.h"
#include "bench/generated.h"
#include "database/imported.h"
#include "query/prepare.h"

namespace vpr {
namespace {

// A database with one generated sequence.
SequenceDatabase generated_database(const TrainingBenchSettings& settings, size_t frames,
                                    uint64_t seed) {
  const GeneratedVectors vectors =
      generate_vectors(frames, settings.descriptor_length, settings.precision, seed, seed + 1);
  SequenceDatabase database;
  database.descriptors.kind =
      &descriptor_kind(settings.precision == 8 ? kNarrowVectorKind : kVectorKind);
  database.descriptors.append(vectors.rows());
  Sequence& sequence = database.sequences.emplace_back().sequence;
  sequence.name = "generated";
  sequence.frames = frames;
  return database;
}

double processor_ms() {
  return 1000 * static_cast<double>(std::clock()) / static_cast<double>(CLOCKS_PER_SEC);
}

// The exponent e of a processor time that grows as frames^e from one row to the next.
double growth_exponent(const BenchRow& before, const BenchRow& row) {
  const double times =
      *find_number(row.values, "processor_ms") / *find_number(before.values, "processor_ms");
  const double frames =
      *find_number(row.parameters, "frames") / *find_number(before.parameters, "frames");
  return std::log(times) / std::log(frames);
}

}  // namespace

BenchResult bench_training(const TrainingBenchSettings& settings, uint64_t seed,
                           const Monitor& monitor) {
  check_values("databases", settings.databases, 100, 10'000'000);
  check_values("descriptor_length", {settings.descriptor_length}, 1, 65536);
  if (settings.precision != 8 && settings.precision != 16)
    throw Error(ErrorKind::usage, "precision is neither 8 nor 16");
  BenchResult result{"training", value_to_json(settings)};
  for (const uint64_t frames : settings.databases) {
    SequenceDatabase database = generated_database(settings, frames, seed);
    reset_peak_memory();
    const Stopwatch watch;
    const double before = processor_ms();
    ensure_exclusion_zones(database, monitor);
    BenchRow row{"train", {{"frames", frames}}, "database", summarize({watch.elapsed_ms()})};
    row.values.emplace_back("processor_ms", processor_ms() - before);
    row.values.emplace_back("peak_mib", peak_memory() >> 20);
    if (!result.rows.empty())
      row.values.emplace_back("exponent", growth_exponent(result.rows.back(), row));
    result.rows.push_back(std::move(row));
  }
  return result;
}

}  // namespace vpr
