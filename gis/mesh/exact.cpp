#include "gis/mesh/exact.h"

#include <array>
#include <cassert>
#include <cmath>
#include <cstddef>

namespace arete {
namespace {

/// A sum kept as doubles that do not overlap, the smallest first.
class Expansion {
 public:
  void add(double value) {
    std::size_t kept = 0;
    for (std::size_t i = 0; i < size_; ++i) {
      const double sum = value + parts_[i];
      const double of_part = sum - value;
      const double rest = (value - (sum - of_part)) + (parts_[i] - of_part);
      if (rest != 0) parts_[kept++] = rest;
      value = sum;
    }
    if (value != 0) parts_[kept++] = value;
    size_ = kept;
  }
  void add_product(double a, double b) {
    const double product = a * b;
    add(std::fma(a, b, -product));
    add(product);
  }
  int sign() const { return size_ == 0 ? 0 : parts_[size_ - 1] > 0 ? 1 : -1; }

 private:
  std::array<double, 64> parts_{};  // 8 weights of 3 doubles each, 2 doubles per product
  std::size_t size_ = 0;
};

}  // namespace

int exact_sign(std::span<const Int128> weights, std::span<const double> values) {
  assert(weights.size() == values.size() && weights.size() <= 8);
  Expansion sum;
  for (std::size_t i = 0; i < weights.size(); ++i)
    for (Int128 rest = weights[i]; rest != 0;) {
      const auto part = static_cast<double>(rest);
      sum.add_product(part, values[i]);
      rest -= static_cast<Int128>(part);
    }
  return sum.sign();
}

}  // namespace arete
