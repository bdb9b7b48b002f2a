#pragma once

// Where the library is known to work: its layouts, bit tricks and floating-point rules are those of these machines and
// compilers. Refused here by name, because elsewhere it would compile and be wrong, or fail somewhere in its middle.

#if !defined(__GNUC__)
#error "sweepgrid needs GCC 12 or Clang 14, or later ones: this compiler is neither."
#endif

#if __SIZEOF_POINTER__ != 8
#error "sweepgrid is for 64-bit machines: indices and counters would overflow here."
#endif

#if __BYTE_ORDER__ != __ORDER_LITTLE_ENDIAN__
#error "sweepgrid is for little-endian machines: it reads numbers in parts, the lower one first."
#endif
