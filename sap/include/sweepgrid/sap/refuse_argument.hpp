#pragma once

namespace sweepgrid {

/// Throws std::invalid_argument with this text. In the library, so that headers compile where exceptions are off.
[[noreturn]] void refuse_argument(const char* why);

}  // namespace sweepgrid
