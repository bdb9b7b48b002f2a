#include "engine_oracle_play.hpp"

namespace sweepgrid::oracle {

std::string play_matrix_d2(const SceneRegime& regime) { return play_matrix<double, 2>(regime, 6); }

}  // namespace sweepgrid::oracle
