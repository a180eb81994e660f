// Any bytes as a .npy array.
#include "base/npy.h"
#include "fuzz.h"

void vpr::fuzz::run(std::string_view input) {
  const NpyArray array(memory_file(input));
  volatile float sum = 0;
  for (const float value : array.values<float>(2)) sum = sum + value;
}
