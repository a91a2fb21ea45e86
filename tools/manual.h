#pragma once

#include <string>

#include <CLI/CLI.hpp>

namespace arete::tools {

/// The manual page (roff, man macros) of the command, or of one of its verbs: made from the options that they have.
std::string write_manual(const CLI::App& app);
std::string write_manual(const CLI::App& app, const CLI::App& verb);

/// Adds the hidden verb `arete man [VERB]`, which prints a page; `arete man --all FOLDER` writes all of them.
void add_manual(CLI::App& app);

}  // namespace arete::tools
