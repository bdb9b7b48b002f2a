#include "engine_oracle_play.hpp"

namespace sweepgrid::oracle {

std::string play_matrix_f3(const SceneRegime& regime) { return play_matrix<float, 3>(regime, 3); }

}  // namespace sweepgrid::oracle
