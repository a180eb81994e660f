// Any bytes as the name of an image that carries its place.
#include <cstdint>

#include "evaluation/ground_truth/utm_names.h"

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  vpr::parse_utm_name({reinterpret_cast<const char*>(data), size});
  return 0;
}
