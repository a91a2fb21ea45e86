#include "tools/help.h"

#include <algorithm>

namespace arete::tools {
namespace {

/// "2..64" of "INT in [2 - 64]", "a|b" of "{a,b}"; empty where the check says neither.
std::string readable_check(const std::string& check) {
  const auto inside = [&](char open, char close) {
    const auto from = check.find(open), to = check.rfind(close);
    return from == std::string::npos || to == std::string::npos ? std::string() : check.substr(from + 1, to - from - 1);
  };
  if (std::string words = inside('{', '}'); !words.empty()) {
    std::replace(words.begin(), words.end(), ',', '|');
    return words;
  }
  const std::string range = check.find(" in [") == std::string::npos ? "" : inside('[', ']');
  const auto dash = range.find(" - ");
  return dash == std::string::npos ? "" : range.substr(0, dash) + ".." + range.substr(dash + 3);
}

}  // namespace

std::string readable_type(const CLI::Option& option) {
  if (option.get_items_expected_max() == 0) return "";
  const std::string type = option.get_type_name();
  const auto colon = type.find(':');
  const std::string name = type.substr(0, colon);
  const std::string check = colon == std::string::npos ? "" : readable_check(type.substr(colon + 1));
  if (!check.empty()) return check;
  if (name == "INT" || name == "UINT" || name == "FLOAT") return "N";
  return name == "TEXT" ? "NAME" : name;
}

HelpFormatter::HelpFormatter() {
  label("SUBCOMMAND", "VERB");
  label("Positionals", "Arguments");
  column_width(26);
}

std::string HelpFormatter::make_option_opts(const CLI::Option* option) const {
  if (!option->nonpositional()) {
    const std::string check = readable_type(*option);
    return check == "NAME" || check.empty() ? "" : " " + check;
  }
  const std::string type = readable_type(*option);
  const bool many = option->get_expected_max() == CLI::detail::expected_max_vector_size;
  return (type.empty() ? "" : " " + type) + (many ? "..." : "");
}

std::string HelpFormatter::make_option_usage(const CLI::Option* option) const {
  const std::string name = make_option_name(option, true);
  return option->get_required() ? name : '[' + name + ']';
}

}  // namespace arete::tools
