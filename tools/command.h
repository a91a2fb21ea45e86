#pragma once

#include <cstdint>
#include <memory>
#include <string>

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include "core/support/error.h"
#include "core/support/progress.h"

namespace arete::tools {

/// The options that every verb has.
struct CommonOptions {
  bool json = false;
  bool quiet = false;
  bool overwrite = false;
  int threads = 0;               ///< 0: one per core
  std::int64_t memory_bytes = 0; ///< resolved before a verb runs; default a quarter of the machine
  std::uint64_t seed = 1;
};

/// Adds a verb to the command line with the common options. `run` is called when the command line chose it; it throws
/// arete::Error on failure. `example` is a command line that works, shown by --help.
CLI::App* add_verb(CLI::App& app, const std::string& name, const std::string& description, const std::string& example,
                   std::shared_ptr<CommonOptions> common, std::function<void()> run);

/// A bar with an estimate on stderr, where stderr is a terminal and --quiet is not given; otherwise silent.
/// Throws Error{interrupted} from advance() after SIGINT or SIGTERM.
std::unique_ptr<Progress> make_progress(const CommonOptions& common);

/// The result of a verb on stdout: the text, or with --json the data.
void print_result(const CommonOptions& common, const std::string& text, const nlohmann::json& data);

}  // namespace arete::tools
