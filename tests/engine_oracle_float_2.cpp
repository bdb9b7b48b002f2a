#include "engine_oracle_play.hpp"

namespace sweepgrid::oracle {

std::string play_matrix_f2(const SceneRegime& regime) { return play_matrix<float, 2>(regime, 0); }

}  // namespace sweepgrid::oracle
