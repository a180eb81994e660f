// Any bytes as a data set description.
#include "fuzz.h"
#include "truth/dataset.h"

void vpr::fuzz::run(std::string_view input) { read_dataset(memory_file(input)); }
