# What tools/packaging/check_with_tidy looks at: all sources of library and tools, many files in one, so that clang-tidy
# looks at the standard library only a few times. Nobody builds these targets; clang-tidy takes their commands.
#
# Two files of a unit that give one name to different things do not compile: rename one, or bring their targets into
# different units.

# sweepgrid_add_tidy(<name> UNITS <count> TARGETS <target>...): in so many units the sources of the targets.
function(sweepgrid_add_tidy name)
  cmake_parse_arguments(TIDY "" "UNITS" "TARGETS" ${ARGN})
  add_library(sweepgrid_tidy_${name} OBJECT EXCLUDE_FROM_ALL)
  foreach(target IN LISTS TIDY_TARGETS)
    get_target_property(folder ${target} SOURCE_DIR)
    get_target_property(sources ${target} SOURCES)
    # Highway includes it anew for every instruction set: a unit of its own, as it is compiled anyway.
    list(REMOVE_ITEM sources src/row_kernels.cpp)
    foreach(source IN LISTS sources)
      cmake_path(ABSOLUTE_PATH source BASE_DIRECTORY ${folder})
      target_sources(sweepgrid_tidy_${name} PRIVATE ${source})
    endforeach()
    foreach(property INCLUDE_DIRECTORIES COMPILE_DEFINITIONS)
      set(${property} $<REMOVE_DUPLICATES:$<TARGET_PROPERTY:${target},${property}>>)
    endforeach()
    target_include_directories(sweepgrid_tidy_${name} PRIVATE ${INCLUDE_DIRECTORIES})
    target_compile_definitions(sweepgrid_tidy_${name} PRIVATE ${COMPILE_DEFINITIONS})
  endforeach()
  target_compile_features(sweepgrid_tidy_${name} PRIVATE cxx_std_20)
  get_target_property(sources sweepgrid_tidy_${name} SOURCES)
  list(LENGTH sources count)
  math(EXPR batch "(${count} + ${TIDY_UNITS} - 1) / ${TIDY_UNITS}")
  set_target_properties(sweepgrid_tidy_${name} PROPERTIES UNITY_BUILD ON UNITY_BUILD_BATCH_SIZE ${batch})
endfunction()

sweepgrid_add_tidy(library UNITS 1 TARGETS sweepgrid_sap sweepgrid_grid sweepgrid_scheduler sweepgrid_engine)
sweepgrid_add_tidy(scenes UNITS 1 TARGETS
  sweepgrid_scenes sweepgrid_baselines sweepgrid_accuracy sweepgrid_setup sweepgrid_tune)
sweepgrid_add_tidy(studies UNITS 1 TARGETS
  sweepgrid_accuracy_study sweepgrid_stability sweepgrid_report sweepgrid_cli)
sweepgrid_add_tidy(program UNITS 2 TARGETS sweepgrid_tool sweepgrid_study)
