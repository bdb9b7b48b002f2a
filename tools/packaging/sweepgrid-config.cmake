include(CMakeFindDependencyMacro)
find_dependency(TBB)
find_dependency(hwy)
include(${CMAKE_CURRENT_LIST_DIR}/sweepgrid-targets.cmake)
