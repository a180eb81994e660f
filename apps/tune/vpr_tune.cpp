// vpr-tune: which window, which threshold? Whole grids for little more than one query.
#include "tune_inputs.h"

int main(int argc, char** argv) {
  using namespace vpr;
  Program program("vpr-tune", "Choose window lengths and thresholds: whole grids in one pass.",
                  "  vpr-tune fastable corridor.vprdb --query corridor/query --ground-truth "
                  "aligned --tolerance 3 --save-config best.json\n"
                  "  vpr-query corridor.vprdb --query another/walk --config best.json\n"
                  "  vpr-tune calibrate corridor.vprdb --query corridor/query --ground-truth "
                  "aligned --tolerance 3 --fps 2 -o calibrated.json");
  FastableTune fastable;
  add_fastable(program, fastable);
  FabmapTune fabmap;
  add_fabmap(program, fabmap);
  CalibrateTune calibrate;
  add_calibrate(program, calibrate);
  ThresholdTune threshold;
  add_threshold(program, threshold);
  return program.main(argc, argv);
}
