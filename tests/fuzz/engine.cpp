// Bytes as a program of calls to an engine, beside brute force. The first byte chooses the type of numbers, the
// dimensions and the key; then follow settings, and calls. See engine_program.hpp.
#include <cstddef>
#include <cstdint>

#include "engine_program.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace sweepgrid::fuzz;  // NOLINT(google-build-using-namespace)
  Input input({data, size});
  switch (input.below(9)) {
    case 0:
      EngineProgram<float, 2>::run(input);
      break;
    case 1:
      EngineProgram<float, 3>::run(input);
      break;
    case 2:
      EngineProgram<double, 2>::run(input);
      break;
    case 3:
      EngineProgram<double, 3>::run(input);
      break;
    case 4:
      EngineProgram<std::int32_t, 2>::run(input);
      break;
    case 5:
      EngineProgram<std::int32_t, 3>::run(input);
      break;
    case 6:
      EngineProgram<std::int16_t, 2>::run(input);
      break;
    case 7:
      EngineProgram<std::int16_t, 3>::run(input);
      break;
    default:
      EngineProgram<float, 3, TextKey, TextKeyHash>::run(input);
      break;
  }
  return 0;
}
