#pragma once

#include <cstdint>
#include <functional>
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
  std::string command_line;      ///< as the user gave it, quoted for a shell: for metadata and reports
};

/// Adds a verb to the command line with the common options. `run` is called when the command line chose it; it throws
/// arete::Error on failure. `example` is one command line that works, or several in lines, shown by --help and in the manual.
CLI::App* add_verb(CLI::App& app, const std::string& name, const std::string& description, const std::string& example,
                   std::shared_ptr<CommonOptions> common, std::function<void()> run);

/// A check of options: a finite number above 0.
CLI::Validator above_zero();

/// A bar with an estimate on stderr, where stderr is a terminal and --quiet is not given; otherwise silent.
/// While it lives SIGINT and SIGTERM are caught, and advance() throws Error{interrupted}; a second signal ends at once.
std::unique_ptr<Progress> make_progress(const CommonOptions& common);

/// One line on stderr that does not stop the work. Silent with --quiet.
void warn(const CommonOptions& common, const std::string& message);

/// The result of a verb on stdout: the text, or with --json the data.
void print_result(const CommonOptions& common, const std::string& text, const nlohmann::json& data);

/// "1234567" bytes as "1.2 MB".
std::string readable_bytes(std::int64_t bytes);

/// The arguments as one line that a shell reads back as the same arguments.
std::string quote_command_line(int argc, const char* const* argv);

}  // namespace arete::tools
