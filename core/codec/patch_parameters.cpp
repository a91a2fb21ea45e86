// É. Guérin, J. Digne, É. Galin, A. Peytavie, "Sparse representation of terrains for procedural modeling", Eurographics 2016.
#include "core/codec/patch_parameters.h"

#include <algorithm>
#include <cmath>

#include "core/codec/byte_stream.h"
#include "core/codec/patch_atoms.h"
#include "core/support/error.h"

namespace arete {
namespace {

constexpr std::size_t digest_bytes = 16;
constexpr std::size_t place_at = 16;  // bytes before the place of the dictionary
constexpr float greatest_quantum = 1e30F;

// --- reading within limits

int get_within(ByteReader& in, const char* what, int least, int most) {
  const int value = in.get_u8();
  if (value < least || value > most)
    in.fail(std::string("the ") + what + " is " + std::to_string(value) + ", " + std::to_string(least) + " to " + std::to_string(most) + " expected");
  return value;
}

float get_quantum(ByteReader& in) {
  const auto value = in.get<float>();
  if (!(value > 0 && value <= greatest_quantum)) in.fail("a quantum is " + std::to_string(value) + ", more than 0 and at most 1e30 expected");
  return value;
}

// --- digests: 32 hexadecimal digits as 16 bytes

int digit_value(char c) {
  if (c >= '0' && c <= '9') return c - '0';
  return c >= 'a' && c <= 'f' ? c - 'a' + 10 : 0;
}

void put_digest(ByteWriter& out, const std::string& digest) {
  for (std::size_t i = 0; i < digest_bytes; ++i)
    out.put_u8(static_cast<std::uint8_t>(2 * i + 1 < digest.size() ? 16 * digit_value(digest[2 * i]) + digit_value(digest[2 * i + 1]) : 0));
}

std::string get_digest(ByteReader& in) {
  std::string digest;
  for (std::size_t i = 0; i < digest_bytes; ++i) {
    const unsigned byte = in.get_u8();
    digest += "0123456789abcdef"[byte >> 4];
    digest += "0123456789abcdef"[byte & 15U];
  }
  return digest;
}

PatchAtoms find_atoms(const std::string& digest, int side, std::int64_t count, const std::string& name, const DictionaryFinder& find) {
  if (!find) throw Error(ErrorKind::input, "'" + name + "' needs the dictionary " + digest + ", which is not here");
  const Eigen::MatrixXf low = find(digest);
  if (low.rows() != std::int64_t{side} * side || low.cols() != count)
    throw Error(ErrorKind::input, "dictionary " + digest + ": expected " + std::to_string(count) + " atoms of " + std::to_string(side) + " x " +
                                      std::to_string(side) + " samples, found " + std::to_string(low.cols()) + " of " + std::to_string(low.rows()) +
                                      " samples: the tree was made with another one");
  return round_atoms(low);
}

}  // namespace

bool inside_disc(int side, int x, int y) {
  const int dx = 2 * x + 1 - side, dy = 2 * y + 1 - side;
  return dx * dx + dy * dy < side * side;
}

std::int64_t disc_samples(int side) {
  std::int64_t count = 0;
  for (int y = 0; y < side; ++y)
    for (int x = 0; x < side; ++x) count += inside_disc(side, x, y);
  return count;
}

PatchAtoms round_atoms(const Eigen::MatrixXf& low) {
  int side = 0;
  while (std::int64_t{side} * side < low.rows()) ++side;
  PatchAtoms atoms{side, low.cols(), std::vector<std::int16_t>(static_cast<std::size_t>(low.size()))};
  for (std::int64_t j = 0; j < atoms.count; ++j)
    for (int y = 0; y < side; ++y)
      for (int x = 0; x < side; ++x) {
        if (!inside_disc(side, x, y)) continue;
        const std::int64_t i = y * side + x;
        // A power of two times a float, rounded half away from zero: exact on every machine.
        const double scaled = std::round(static_cast<double>(low(i, j)) * 32768);
        atoms.samples[static_cast<std::size_t>(j * side * side + i)] = static_cast<std::int16_t>(std::clamp(scaled, -32767.0, 32767.0));
      }
  return atoms;
}

std::string named_dictionary(std::span<const std::byte> parameters) {
  if (parameters.size() != place_at + 1 + digest_bytes || parameters[place_at] != std::byte{1}) return {};
  ByteReader in(parameters.last(digest_bytes), "the parameters");
  return get_digest(in);
}

std::vector<std::byte> serialise_patch_parameters(const PatchParameters& parameters) {
  ByteWriter out;
  out.put_u8(static_cast<std::uint8_t>(parameters.radius));
  out.put_u8(static_cast<std::uint8_t>(parameters.sparsity));
  out.put(static_cast<std::uint16_t>(parameters.atoms.count));
  out.put(parameters.base);
  out.put(parameters.mean_quantum);
  out.put(parameters.coefficient_quantum);
  out.put_u8(parameters.dictionary.empty() ? 0 : 1);
  if (parameters.dictionary.empty())
    out.put_bytes(encode_atoms(parameters.atoms));
  else
    put_digest(out, parameters.dictionary);
  return out.take();
}

PatchParameters parse_patch_parameters(std::span<const std::byte> bytes, const std::string& name, const NodeGrid& grid, const DictionaryFinder& find) {
  ByteReader in(bytes, name);
  PatchParameters parameters;
  parameters.grid = grid;
  parameters.radius = get_within(in, "radius of the discs", least_patch_radius, greatest_patch_radius);
  parameters.sparsity = get_within(in, "number of coefficients of a disc", 1, most_patch_sparsity);
  const std::int64_t count = in.get<std::uint16_t>();
  parameters.base = in.get<float>();
  if (!std::isfinite(parameters.base)) in.fail("the base elevation is not finite");
  parameters.mean_quantum = get_quantum(in);
  parameters.coefficient_quantum = get_quantum(in);
  const bool elsewhere = get_within(in, "place of the dictionary", 0, 1) == 1;
  const int side = 2 * parameters.radius;
  if (elsewhere) {
    parameters.dictionary = get_digest(in);
    if (in.left() > 0) in.fail("its parameters are followed by " + std::to_string(in.left()) + " bytes too many");
    parameters.atoms = find_atoms(parameters.dictionary, side, count, name, find);
    return parameters;
  }
  const std::int64_t least = least_atom_bytes(side, count);
  if (static_cast<std::int64_t>(in.left()) < least)
    in.fail(std::to_string(count) + " atoms take at least " + std::to_string(least) + " bytes, found " + std::to_string(in.left()));
  parameters.atoms = decode_atoms(bytes.last(in.left()), side, count);
  return parameters;
}

ValueRatio value_ratio(std::int64_t atoms, std::int64_t atom_samples, std::int64_t discs, int sparsity, std::int64_t cells) {
  const double dictionary = static_cast<double>(atoms) * static_cast<double>(atom_samples);
  const auto n = static_cast<double>(discs), t0 = static_cast<double>(cells);
  return {(dictionary + n * (2 * sparsity + 2) + 1) / t0, (dictionary + 2 * n * sparsity) / t0};
}

}  // namespace arete
