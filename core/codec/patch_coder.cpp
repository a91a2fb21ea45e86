#include "core/codec/patch_coder.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "core/codec/patch_blend.h"
#include "core/sparse/constrained.h"
#include "core/sparse/ksvd.h"
#include "core/sparse/learning_steps.h"
#include "core/sparse/omp.h"
#include "core/sparse/patches.h"
#include "core/support/error.h"
#include "core/support/parallel.h"

namespace arete {
namespace {

constexpr std::int64_t most_learning_patches = 65536;
constexpr double finest_psnr_db = 100;  // quantisation need not be finer than this
constexpr int most_atom_shift = 10;     // steps of 2^-5 of an atom: coarser ones leave nothing of it
constexpr int searches = 6;             // for the quantum

// --- blocks of discs in memory

class DiscField {
 public:
  explicit DiscField(const PatchParameters& parameters)
      : size_(parameters.grid.size()), side_(parameters.grid.side()), radius_(parameters.radius), blocks_(disc_blocks(parameters.grid)) {}
  Size blocks() const { return blocks_; }
  std::int64_t column(std::int64_t disc) const { return block_of(disc, size_.width, blocks_.width); }
  std::int64_t row(std::int64_t disc) const { return block_of(disc, size_.height, blocks_.height); }

 private:
  std::int64_t block_of(std::int64_t disc, std::int64_t cells, std::int64_t count) const {
    return std::min(node_of_disc(disc, cells, side_, radius_), count - 1);
  }
  Size size_;
  int side_, radius_;
  Size blocks_;
};

// The blocks [x, x + width) x [y, y + height) of a field.
struct BlockWindow {
  DiscField field;
  Window at;
  std::vector<DiscBlock> blocks;
  DiscView disc(std::int64_t column, std::int64_t row) const {
    const DiscBlock& block = blocks[static_cast<std::size_t>((field.row(row) - at.y) * at.width + field.column(column) - at.x)];
    const std::int64_t i = block.index(column, row);
    return {block.means[static_cast<std::size_t>(i)], block.terms_of(i)};
  }
};

std::int64_t stream_index(const NodeGrid& grid, std::int64_t x, std::int64_t y) { return grid.index({1, x, y}); }

// --- learning

std::vector<PatchOrigin> origins_of(const PatchGrid& grid, const PatchRange& columns, const PatchRange& rows) {
  std::vector<PatchOrigin> origins;
  for (std::int64_t j = rows.begin; j < rows.end; ++j)
    for (std::int64_t i = columns.begin; i < columns.end; ++i) origins.push_back({patch_origin(grid, i), patch_origin(grid, j), 0});
  return origins;
}

Eigen::MatrixXf learn_atoms(RasterView<const float> cells, const PatchGrid& grid, const PatchCodingOptions& options, Progress& progress) {
  const std::int64_t wide = patches_along(grid, cells.width), high = patches_along(grid, cells.height);
  std::vector<PatchOrigin> origins;
  for (const std::int64_t i : choose_columns(wide * high, most_learning_patches, options.seed))
    origins.push_back({patch_origin(grid, i % wide), patch_origin(grid, i / wide), 0});
  const Eigen::MatrixXf F = cut_patches(cells, grid, origins, true, options.threads).values;
  const int atoms = static_cast<int>(std::min<std::int64_t>(options.atoms, F.cols()));
  if (atoms == 0) return Eigen::MatrixXf(grid.samples(), 0);
  if (options.learning == PatchLearning::constrained)
    return learn_constrained(F, {.atoms = atoms, .sparsity = options.sparsity, .seed = options.seed, .threads = options.threads}, progress).D;
  return learn_ksvd(F, {.atoms = atoms, .sparsity = options.sparsity, .seed = options.seed, .threads = options.threads}, progress).D;
}

// --- quantisation

// The raster coded with one choice of quanta.
struct Coding {
  PatchParameters parameters;
  std::vector<DiscBlock> blocks;
  Eigen::VectorXd energies;  // of the coefficients of each atom, before quantisation
  double squared_error = 0;
};

double atom_norm(const PatchAtoms& atoms, std::int64_t j) {
  double sum = 0;
  for (int i = 0; i < atoms.side * atoms.side; ++i) sum += std::pow(atoms.atom(j)[i] / 32768.0, 2);
  return std::sqrt(sum);
}

// The atoms with samples in steps of 2^(shift - 15), as coarse as what they are used for lets them be.
PatchAtoms quantise_atoms(const Eigen::MatrixXf& D, const Eigen::VectorXd& energies, double quantum) {
  PatchAtoms atoms = round_atoms(D);
  for (std::int64_t j = 0; j < atoms.count; ++j) {
    const double step = quantum / std::sqrt(std::max(energies[j], 1e-300));
    const int shift = static_cast<int>(std::clamp(std::round(std::log2(step)) + 15, 0.0, static_cast<double>(most_atom_shift)));
    const std::int32_t most = 32767 >> shift;
    for (std::int64_t i = 0; i < D.rows(); ++i) {
      std::int16_t& sample = atoms.samples[static_cast<std::size_t>(j * D.rows() + i)];
      if (sample == 0) continue;
      const double scaled = std::round(static_cast<double>(D(i, j)) * std::ldexp(1.0, 15 - shift));
      sample = static_cast<std::int16_t>(std::clamp(static_cast<std::int32_t>(scaled), -most, most) * (1 << shift));
    }
  }
  return atoms;
}

std::int32_t held(double quanta) {
  constexpr double most = patch_value_limit;
  return static_cast<std::int32_t>(std::clamp(std::round(quanta), -most, most));
}

// Everything that coding a block needs, made once for a choice of quanta.
struct Coder {
  RasterView<const float> cells;
  const PatchParameters& parameters;
  PatchGrid grid;
  CodingDictionary dictionary;
  std::vector<double> norms;
};

DiscBlock code_block(const Coder& coder, std::int64_t x, std::int64_t y, Eigen::VectorXd& energies) {
  DiscBlock block = blank_discs(coder.parameters, x, y);
  const Patches patches = cut_patches(coder.cells, coder.grid, origins_of(coder.grid, block.columns, block.rows), false, 1);
  SparseCodes codes;
  if (coder.parameters.atoms.count > 0) codes = omp(coder.dictionary, patches.values, coder.parameters.sparsity, 1);
  const double base = coder.parameters.base, step = coder.parameters.mean_quantum;
  for (std::int64_t i = 0; i < block.count(); ++i) {
    block.means[static_cast<std::size_t>(i)] = held((patches.means[static_cast<std::size_t>(i)] - base) / step);
    const auto begin = static_cast<std::ptrdiff_t>(block.terms.size());
    for (std::int64_t t = 0; t < codes.sparsity(); ++t) {
      const std::int32_t atom = codes.atoms(t, i);
      if (atom < 0) continue;
      const double value = codes.coefficients(t, i), norm = coder.norms[static_cast<std::size_t>(atom)];
      energies[atom] += value * value;
      const std::int32_t coefficient = held(value / (norm * static_cast<double>(coder.parameters.coefficient_quantum)));
      if (coefficient != 0) block.terms.push_back({atom, coefficient});
    }
    std::sort(block.terms.begin() + begin, block.terms.end(), [](const DiscTerm& a, const DiscTerm& b) { return a.atom < b.atom; });
    block.first[static_cast<std::size_t>(i) + 1] = static_cast<std::uint32_t>(block.terms.size());
  }
  return block;
}

double squared_error(RasterView<const float> cells, const PatchParameters& parameters, BlockWindow& window, int threads) {
  const DiscBlend blend(parameters);
  constexpr std::int64_t tile = 256;
  const std::int64_t wide = (cells.width + tile - 1) / tile, high = (cells.height + tile - 1) / tile;
  std::vector<double> sums(static_cast<std::size_t>(wide * high));
  parallel_for(wide * high, threads, [&](std::int64_t i) {
    const std::int64_t x = i % wide * tile, y = i / wide * tile;
    const Window at{x, y, std::min(tile, cells.width - x), std::min(tile, cells.height - y)};
    Raster<float> f(at.width, at.height);
    blend.evaluate(0, at, [&](std::int64_t column, std::int64_t row) { return window.disc(column, row); }, f.view(), 1);
    for (std::int64_t row = 0; row < at.height; ++row)
      for (std::int64_t column = 0; column < at.width; ++column) {
        const double error = static_cast<double>(f(column, row)) - static_cast<double>(cells(x + column, y + row));
        sums[static_cast<std::size_t>(i)] += error * error;
      }
  });
  double sum = 0;
  for (const double s : sums) sum += s;
  return sum;
}

// An error in a mean weighs so much more than one of the same size in the coefficient of a unit atom.
double mean_gain(const PatchGrid& grid) {
  double sum = 0;
  for (const float w : grid.weights) sum += static_cast<double>(w) * static_cast<double>(w);
  return std::sqrt(sum);
}

Coding code_raster(RasterView<const float> cells, PatchParameters parameters, const Eigen::MatrixXf& D, const Eigen::VectorXd& energies, double quantum,
                   bool atoms_given, int threads) {
  Coding coding{std::move(parameters), {}, Eigen::VectorXd::Zero(D.cols()), 0};
  PatchParameters& p = coding.parameters;
  p.coefficient_quantum = static_cast<float>(quantum);
  p.mean_quantum = static_cast<float>(quantum / mean_gain(p.patch_grid()));
  p.atoms = atoms_given ? round_atoms(D) : quantise_atoms(D, energies, quantum);

  Eigen::MatrixXf units(D.rows(), D.cols());
  Coder coder{cells, p, p.patch_grid(), {}, {}};
  for (std::int64_t j = 0; j < D.cols(); ++j) {
    coder.norms.push_back(atom_norm(p.atoms, j));
    const double norm = coder.norms.back() > 0 ? 32768 * coder.norms.back() : 1;
    for (std::int64_t i = 0; i < D.rows(); ++i) units(i, j) = static_cast<float>(p.atoms.atom(j)[i] / norm);
  }
  if (D.cols() > 0) coder.dictionary = prepare_coding(units, p.sparsity, threads);

  const DiscField field(p);
  const Size blocks = field.blocks();
  BlockWindow window{field, {0, 0, blocks.width, blocks.height}, std::vector<DiscBlock>(static_cast<std::size_t>(blocks.cells()))};
  std::vector<Eigen::VectorXd> sums(window.blocks.size(), Eigen::VectorXd::Zero(D.cols()));
  parallel_for(blocks.cells(), threads, [&](std::int64_t i) {
    const auto at = static_cast<std::size_t>(i);
    window.blocks[at] = code_block(coder, i % blocks.width, i / blocks.width, sums[at]);
  });
  for (const Eigen::VectorXd& sum : sums) coding.energies += sum;
  coding.squared_error = squared_error(cells, p, window, threads);
  coding.blocks = std::move(window.blocks);
  return coding;
}

struct Relief {
  double least, most;
};

Relief relief_of(RasterView<const float> cells) {
  Relief relief{static_cast<double>(cells(0, 0)), static_cast<double>(cells(0, 0))};
  for (std::int64_t y = 0; y < cells.height; ++y)
    for (std::int64_t x = 0; x < cells.width; ++x) {
      relief.least = std::min(relief.least, static_cast<double>(cells(x, y)));
      relief.most = std::max(relief.most, static_cast<double>(cells(x, y)));
    }
  return relief;
}

// The coarsest quantum whose error stays below the wanted one, and the finest coding as the measure.
Coding search_quantum(RasterView<const float> cells, const PatchParameters& parameters, const Eigen::MatrixXf& D, double peak, bool atoms_given,
                      const PatchCodingOptions& options, double& unquantised) {
  const double finest = peak > 0 ? peak * 0x1p-18 : 1;
  Coding reference = code_raster(cells, parameters, D, Eigen::VectorXd::Constant(D.cols(), 1e300), finest, atoms_given, options.threads);
  unquantised = reference.squared_error;
  const auto count = static_cast<double>(cells.size().cells());
  const double floor = count * std::pow(peak * std::pow(10, -finest_psnr_db / 20), 2);
  const double room = std::max(unquantised * (std::pow(10, options.quantiser_loss_db / 10) - 1), floor);

  std::optional<Coding> best;
  double values = 0;
  for (const DiscBlock& block : reference.blocks) values += static_cast<double>(block.means.size() + block.terms.size());
  if (!atoms_given) values += static_cast<double>(D.cols() * disc_samples(2 * parameters.radius));
  // Errors of uniform quantisers, which the blend about doubles (1 / cover, 0.5 to 1).
  double quantum = std::sqrt(6 * room / std::max(1.0, values));
  for (int i = 0; i < searches && quantum > finest; ++i) {
    Coding coding = code_raster(cells, parameters, D, reference.energies, quantum, atoms_given, options.threads);
    const double used = std::max(1e-3 * room, coding.squared_error - unquantised);
    if (used <= room && (!best || coding.parameters.coefficient_quantum > best->parameters.coefficient_quantum)) best = std::move(coding);
    if (used <= room && used > 0.9 * room) break;
    quantum *= std::sqrt(0.95 * room / used);
  }
  return best ? std::move(*best) : std::move(reference);
}

void check(const PatchCodingOptions& options) {
  const auto within = [](const char* name, std::int64_t value, std::int64_t least, std::int64_t most) {
    if (value < least || value > most)
      throw Error(ErrorKind::usage, std::string(name) + " of " + std::to_string(value) + ": expected " + std::to_string(least) + " to " + std::to_string(most));
  };
  within("radius", options.radius, least_patch_radius, greatest_patch_radius);
  within("sparsity", options.sparsity, 1, most_patch_sparsity);
  within("number of atoms", options.dictionary ? options.dictionary->cols() : options.atoms, 0, most_patch_atoms);
  const std::int64_t samples = 4 * std::int64_t{options.radius} * options.radius;
  if (options.dictionary && options.dictionary->rows() != samples)
    throw Error(ErrorKind::usage, "dictionary of atoms with " + std::to_string(options.dictionary->rows()) + " samples: a radius of " +
                                      std::to_string(options.radius) + " cells needs " + std::to_string(samples));
}

}  // namespace

std::int64_t PatchStreams::bytes() const {
  auto sum = static_cast<std::int64_t>(serialise_patch_parameters(parameters).size() + root.size());
  for (const std::vector<std::byte>& node : nodes) sum += static_cast<std::int64_t>(node.size());
  return sum;
}

PatchStreams encode_patches(RasterView<const float> cells, const PatchCodingOptions& options, Progress& progress) {
  check(options);
  PatchParameters parameters;
  parameters.grid = NodeGrid(cells.size(), options.node_side);
  parameters.radius = options.radius;
  parameters.sparsity = options.sparsity;
  const Relief relief = relief_of(cells);
  parameters.base = static_cast<float>(relief.least + (relief.most - relief.least) / 2);
  const Eigen::MatrixXf D = options.dictionary ? *options.dictionary : learn_atoms(cells, parameters.patch_grid(), options, progress);
  parameters.dictionary = options.dictionary ? options.dictionary_name : "";

  PatchStreams streams;
  Coding coding = search_quantum(cells, parameters, D, relief.most - relief.least, !parameters.dictionary.empty(), options,
                                 streams.unquantised_squared_error);
  streams.squared_error = coding.squared_error;
  streams.parameters = std::move(coding.parameters);
  const NodeGrid& grid = streams.parameters.grid;
  streams.nodes.resize(static_cast<std::size_t>(grid.node_count()));
  const AtomMoments moments = find_moments(streams.parameters.atoms);
  std::vector<std::vector<std::byte>> bytes(coding.blocks.size());
  parallel_for(static_cast<std::int64_t>(bytes.size()), options.threads, [&](std::int64_t i) {
    const auto at = static_cast<std::size_t>(i);
    bytes[at] = encode_discs(streams.parameters, moments, coding.blocks[at]);
  });
  for (const DiscBlock& block : coding.blocks) streams.discs += block.count();
  const Size blocks = disc_blocks(grid);
  for (std::size_t i = 0; i < bytes.size(); ++i) {
    const auto at = static_cast<std::int64_t>(i);
    (grid.levels() == 0 ? streams.root : streams.nodes[static_cast<std::size_t>(stream_index(grid, at % blocks.width, at / blocks.width))]) = std::move(bytes[i]);
  }
  return streams;
}

Raster<float> decode_patches(const PatchParameters& parameters, std::span<const std::byte> root, const StreamReader& streams, int level,
                             const Window& window, int threads) {
  const NodeGrid& grid = parameters.grid;
  const DiscBlend blend(parameters);
  const DiscField field(parameters);
  const PatchRange columns = blend.discs_reaching(window.x, window.x + window.width, level);
  const PatchRange rows = blend.discs_reaching(window.y, window.y + window.height, level);
  const std::int64_t x = field.column(columns.begin), y = field.row(rows.begin);
  BlockWindow discs{field, {x, y, field.column(columns.end - 1) - x + 1, field.row(rows.end - 1) - y + 1}, {}};
  discs.blocks.resize(static_cast<std::size_t>(discs.at.width * discs.at.height));
  const AtomMoments moments = find_moments(parameters.atoms);
  parallel_for(discs.at.width * discs.at.height, threads, [&](std::int64_t i) {
    const std::int64_t bx = x + i % discs.at.width, by = y + i / discs.at.width;
    DiscBlock& block = discs.blocks[static_cast<std::size_t>(i)] = blank_discs(parameters, bx, by);
    if (grid.levels() == 0) return decode_discs(parameters, moments, root, block);
    decode_discs(parameters, moments, streams(stream_index(grid, bx, by)), block);
  });
  Raster<float> out(window.width, window.height);
  blend.evaluate(level, window, [&](std::int64_t column, std::int64_t row) { return discs.disc(column, row); }, out.view(), threads);
  return out;
}

}  // namespace arete
