// Any bytes as the name of an image with its position.
#include "fuzz.h"
#include "truth/readers.h"

void vpr::fuzz::run(std::string_view input) { parse_utm_name(input); }
