#pragma once

// PLATOON_VECTOR_CLONES before a function compiles it for the baseline and for wider vectors; the loader selects a
// version, so one binary serves every x86-64 machine. All versions give the same bits: each lane does the same IEEE
// operations in the same order, without contraction (-ffp-contract=off). Functions called from it must be
// PLATOON_INLINE to be compiled with it. Disabled under sanitizers, as the loader selects before their start.
#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__) && !defined(__SANITIZE_ADDRESS__) && \
    !defined(__SANITIZE_THREAD__)
#define PLATOON_VECTOR_CLONES __attribute__((target_clones("avx512f", "avx2", "default")))
#else
#define PLATOON_VECTOR_CLONES
#endif

// PLATOON_WIDE before a function compiles it for vectors of eight doubles; only where has_wide_lanes().
#if defined(__x86_64__) && defined(__GNUC__)
#define PLATOON_WIDE __attribute__((target("avx512f")))
#endif

#define PLATOON_INLINE inline __attribute__((always_inline))

namespace platoon {

inline bool has_wide_lanes() {
#ifdef PLATOON_WIDE
  static const bool has = __builtin_cpu_supports("avx512f") != 0;
  return has;
#else
  return false;
#endif
}

}  // namespace platoon
