#pragma once

// Cells are found with floating-point numbers, the same ones wherever a box is looked up. A file that compiles this
// code for a scalar or a number of axes of its own needs a compiler that keeps to the rules. Files that use engines
// which are compiled into the library may have any flags.
#if defined(__FAST_MATH__) || (defined(__FINITE_MATH_ONLY__) && __FINITE_MATH_ONLY__) || defined(__ASSOCIATIVE_MATH__)
#error "sweepgrid: compile the file that instantiates an engine for other types without -ffast-math."
#endif
