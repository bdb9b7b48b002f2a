// The engine says exactly what brute force says, after every step, for every kind of cell, scalar, dimension, grid and
// thread count, however the calls are made.
#include <gtest/gtest.h>

#include "engine_oracle_play.hpp"

namespace sweepgrid::oracle::engine_oracle_test {
namespace {

std::string name_of(const ::testing::TestParamInfo<SceneRegime>& info) { return info.param.name; }
std::string cell_name_of(const ::testing::TestParamInfo<Regime>& info) { return info.param.name; }

class EngineOracle : public ::testing::TestWithParam<SceneRegime> {};

TEST_P(EngineOracle, SaysWhatBruteForceSaysInFloat2) { EXPECT_EQ(play_matrix_f2(GetParam()), ""); }
TEST_P(EngineOracle, SaysWhatBruteForceSaysInFloat3) { EXPECT_EQ(play_matrix_f3(GetParam()), ""); }
TEST_P(EngineOracle, SaysWhatBruteForceSaysInDouble2) { EXPECT_EQ(play_matrix_d2(GetParam()), ""); }
TEST_P(EngineOracle, SaysWhatBruteForceSaysInDouble3) { EXPECT_EQ(play_matrix_d3(GetParam()), ""); }
INSTANTIATE_TEST_SUITE_P(Scenes, EngineOracle, ::testing::ValuesIn(kSceneRegimes), name_of);

class EngineOracleInt : public ::testing::TestWithParam<SceneRegime> {};

TEST_P(EngineOracleInt, SaysWhatBruteForceSaysInOneAndFourDimensions) { EXPECT_EQ(play_int(GetParam()), ""); }
INSTANTIATE_TEST_SUITE_P(Scenes, EngineOracleInt, ::testing::ValuesIn(kSceneRegimes), name_of);

class EngineOracleCells : public ::testing::TestWithParam<Regime> {};

TEST_P(EngineOracleCells, SaysWhatBruteForceSays) { EXPECT_EQ(play_cell_script(GetParam()), ""); }
INSTANTIATE_TEST_SUITE_P(Scripts, EngineOracleCells, ::testing::ValuesIn(kRegimes), cell_name_of);

class EngineOracleLarge : public ::testing::TestWithParam<int> {};

TEST_P(EngineOracleLarge, GrowsFromTenToThousandsAndBack) { EXPECT_EQ(play_large(GetParam()), ""); }
INSTANTIATE_TEST_SUITE_P(Threads, EngineOracleLarge, ::testing::ValuesIn(kThreadCounts),
                         ::testing::PrintToStringParamName());

}  // namespace
}  // namespace sweepgrid::oracle::engine_oracle_test
