#include "report/posterior_file.h"

#include <limits>

#include "base/json.h"
#include "base/npy.h"
#include "report/result_file.h"

namespace vpr {

PosteriorFile::PosteriorFile(Output& file, size_t frames, size_t views)
    : file_(file), frames_(frames), columns_(views + 1) {
  file_.write(npy_header(npy_type<double>(), {frames, columns_}));
}

void PosteriorFile::add(std::span<const double> posterior) {
  std::vector<double> row(posterior.begin(), posterior.end());
  row.resize(columns_, posterior.empty() ? std::numeric_limits<double>::quiet_NaN() : 0);
  file_.write(std::as_bytes(std::span<const double>(row)));
}

Json PosteriorFile::entry(const Monitor& monitor) const {
  return file_entry(file_.temporary(), frames_, monitor);
}

}  // namespace vpr
