#include "engine_program.hpp"

namespace sweepgrid::fuzz {

template class EngineProgram<double, 2>;
template class EngineProgram<double, 3>;

}  // namespace sweepgrid::fuzz
