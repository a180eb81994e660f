// How the toolkit uses Highway: include before any header of it, in every file that is compiled
// once for each SIMD target.
#pragma once

#define HWY_WANT_AVX3_DL  // without it, popcount is a table look-up even where the CPU has one
// SVE and RISC-V vectors have no fixed size and can't be kept in arrays, as the kernels do.
#define HWY_DISABLED_TARGETS (HWY_SVE | HWY_SVE2 | HWY_SVE_256 | HWY_SVE2_128 | HWY_RVV)
