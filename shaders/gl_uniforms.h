#pragma once

#include <array>
#include <cstdint>

namespace arete {

/// Linear red, green and blue.
using Colour3 = std::array<float, 3>;

/// Uniforms of a program by name, in single precision; one that the program has not is left alone.
void set(unsigned program, const char* name, const Colour3& v);
void set(unsigned program, const char* name, double x);
void set(unsigned program, const char* name, double x, double y);
void set(unsigned program, const char* name, const std::array<double, 16>& m);
void set_int(unsigned program, const char* name, int x);
void set_int(unsigned program, const char* name, std::int64_t x, std::int64_t y);

}  // namespace arete
