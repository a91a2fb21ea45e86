#pragma once

#include <string>

#include <CLI/CLI.hpp>

namespace arete::tools {

/// What an option takes, in few characters: "2..64", "land|grey", "N" for a number, or the name that its author gave.
std::string readable_type(const CLI::Option& option);

/// Lays out --help as the manual does.
class HelpFormatter final : public CLI::Formatter {
 public:
  HelpFormatter();
  std::string make_option_opts(const CLI::Option* option) const override;
  std::string make_option_usage(const CLI::Option* option) const override;
};

}  // namespace arete::tools
