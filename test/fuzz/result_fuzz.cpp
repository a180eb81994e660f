// Any bytes as a result of vpr-query, of either family.
#include "base/error.h"
#include "memory_file.h"
#include "report/fabmap_result_file.h"
#include "report/result_file.h"

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  const std::filesystem::path path = vpr::fuzz::memory_file(data, size);
  try {
    vpr::read_result(path);
  } catch (const vpr::Error&) {
  }
  try {
    vpr::read_fabmap_result(path);
  } catch (const vpr::Error&) {
  }
  return 0;
}
