#include "engine_oracle_play.hpp"

namespace sweepgrid::oracle {

std::string play_matrix_d3(const SceneRegime& regime) { return play_matrix<double, 3>(regime, 9); }

}  // namespace sweepgrid::oracle
