#include <sweepgrid/sap/refuse_argument.hpp>

#include <stdexcept>

namespace sweepgrid {

void refuse_argument(const char* why) { throw std::invalid_argument(why); }

}  // namespace sweepgrid
