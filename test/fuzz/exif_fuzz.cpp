// Any bytes as an image that may carry EXIF tags.
#include <cmath>

#include "fuzz.h"
#include "ground_truth/exif.h"

using namespace vpr;

void fuzz::run(std::string_view input) {
  refuses([&] {
    const ImageTags tags = read_exif(input, {"image"});
    if (tags.place) {
      require(std::abs(tags.place->latitude_deg) <= 90);
      require(std::abs(tags.place->longitude_deg) <= 180);
    }
    if (tags.heading_deg) require(*tags.heading_deg >= 0 && *tags.heading_deg <= 360);
  });
}
