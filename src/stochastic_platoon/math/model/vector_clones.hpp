#pragma once

// PLATOON_VECTOR_CLONES before a function compiles its loops several times, for the baseline and for wider
// vectors, and the loader picks: one binary for every x86-64 machine. All versions give the same bits, as
// each lane does the same IEEE operations in the same order; nothing is contracted (-ffp-contract=off). What
// such a function calls must be PLATOON_INLINE to be part of it. The loader picks before a sanitizer is up.
#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__) && !defined(__SANITIZE_ADDRESS__) && \
    !defined(__SANITIZE_THREAD__)
#define PLATOON_VECTOR_CLONES __attribute__((target_clones("avx512f", "avx2", "default")))
#define PLATOON_INLINE inline __attribute__((always_inline))
#else
#define PLATOON_VECTOR_CLONES
#define PLATOON_INLINE inline
#endif
