// Any bytes as a .npy array.
#include "base/npy.h"
#include "memory_file.h"

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  try {
    const vpr::NpyArray array(vpr::fuzz::memory_file(data, size));
    double sum = 0;
    for (const float value : array.values<float>(2)) sum += value;
    (void)sum;
  } catch (const vpr::Error&) {
  }
  return 0;
}
