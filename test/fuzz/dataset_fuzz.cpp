// Any bytes as a data set description.
#include "base/error.h"
#include "images/dataset.h"
#include "memory_file.h"

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  try {
    vpr::read_dataset(vpr::fuzz::memory_file(data, size));
  } catch (const vpr::Error&) {
  }
  return 0;
}
