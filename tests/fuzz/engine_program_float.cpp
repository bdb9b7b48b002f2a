#include "engine_program.hpp"

namespace sweepgrid::fuzz {

template class EngineProgram<float, 2>;
template class EngineProgram<float, 3>;
template class EngineProgram<float, 3, TextKey, TextKeyHash>;

}  // namespace sweepgrid::fuzz
