// Any bytes as the name of an image that carries its place.
#include "fuzz.h"
#include "truth/utm_names.h"

void vpr::fuzz::run(std::string_view input) { parse_utm_name(input); }
