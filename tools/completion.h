#pragma once

#include <string>

#include <CLI/CLI.hpp>

namespace arete::tools {

/// The completion script of `shell` ("bash", "zsh" or "fish") for a command line: its verbs, their options, and the values
/// of the options that have a fixed set. File names complete everywhere else.
std::string write_completion(const CLI::App& app, const std::string& shell);

/// Adds `arete completion SHELL`, which prints the script.
void add_completion(CLI::App& app);

}  // namespace arete::tools
