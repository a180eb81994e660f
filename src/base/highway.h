// Settings for Highway. Include this header before any header of Highway in every file that is
// compiled once per SIMD target.
#pragma once

#define HWY_WANT_AVX3_DL  // without it, popcount is a table look-up even on CPUs with the
                          // instruction
// SVE and RISC-V vectors have no fixed size, so the kernels cannot store them in arrays.
#define HWY_DISABLED_TARGETS (HWY_SVE | HWY_SVE2 | HWY_SVE_256 | HWY_SVE2_128 | HWY_RVV)
