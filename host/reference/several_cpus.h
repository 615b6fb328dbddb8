#pragma once

// Marks a function that is compiled for several x86 instruction sets, of which the loader picks one. A few
// plain loops take most of the oracle's time, and gain 4-8x from the wide vectors that a portable build does
// without. The loader picks before a sanitizer is ready, so sanitized builds have the plain function only.
#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__) && !defined(__SANITIZE_ADDRESS__)
#define MICA_FOR_SEVERAL_CPUS __attribute__((target_clones("arch=x86-64-v4", "arch=x86-64-v3", "default")))
#else
#define MICA_FOR_SEVERAL_CPUS
#endif
