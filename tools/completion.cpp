#include "tools/completion.h"

#include <iostream>
#include <sstream>
#include <vector>

namespace arete::tools {
namespace {

struct Choice {
  std::string name;
  std::string description;
  bool takes_value = false;
  std::vector<std::string> values;  // where the set of them is fixed
};

struct Verb {
  std::string name;
  std::string description;
  std::vector<Choice> options;
};

/// The words of "{a,b,c}" in the type name of an option, as CLI::IsMember writes them.
std::vector<std::string> fixed_values(const CLI::Option& option) {
  const std::string type = option.get_type_name();
  const auto open = type.find('{'), close = type.find('}');
  if (open == std::string::npos || close == std::string::npos) return {};
  std::vector<std::string> values;
  std::istringstream words(type.substr(open + 1, close - open - 1));
  for (std::string word; std::getline(words, word, ',');) values.push_back(word.substr(0, word.find("->")));
  return values;
}

std::vector<Choice> options_of(const CLI::App& app) {
  std::vector<Choice> choices;
  for (const CLI::Option* option : app.get_options())
    for (const std::string& name : option->get_lnames())
      choices.push_back({"--" + name, option->get_description(), option->get_items_expected_max() > 0, fixed_values(*option)});
  return choices;
}

std::vector<Verb> verbs_of(const CLI::App& app) {
  std::vector<Verb> verbs;
  for (const CLI::App* verb : app.get_subcommands([](const CLI::App* v) { return !v->get_group().empty(); }))
    verbs.push_back({verb->get_name(), verb->get_description(), options_of(*verb)});
  return verbs;
}

std::string join(const std::vector<std::string>& words) {
  std::string line;
  for (const std::string& word : words) line += (line.empty() ? "" : " ") + word;
  return line;
}

/// `text` inside single quotes of a shell, without the characters of `unwanted`.
std::string quoted(const std::string& text, const std::string& unwanted = "") {
  std::string safe = "'";
  for (const char c : text) {
    if (unwanted.find(c) != std::string::npos) continue;
    safe += c == '\'' ? std::string("'\\''") : std::string(1, c);
  }
  return safe + "'";
}

void write_bash(std::ostream& out, const std::vector<Verb>& verbs) {
  std::vector<std::string> names;
  for (const Verb& verb : verbs) names.push_back(verb.name);
  out << "# bash completion for arete\n"
         "_arete() {\n"
         "  local word=${COMP_WORDS[COMP_CWORD]} before=${COMP_WORDS[COMP_CWORD-1]} verb=${COMP_WORDS[1]}\n"
         "  COMPREPLY=()\n"
         "  if [ \"$COMP_CWORD\" -eq 1 ]; then\n"
         "    COMPREPLY=($(compgen -W \"" << join(names) << " --help --version\" -- \"$word\"))\n"
         "    return\n"
         "  fi\n"
         "  case \"$verb $before\" in\n";
  for (const Verb& verb : verbs)
    for (const Choice& option : verb.options)
      if (!option.values.empty())
        out << "    '" << verb.name << ' ' << option.name << "') COMPREPLY=($(compgen -W \"" << join(option.values)
            << "\" -- \"$word\")); return ;;\n";
  out << "  esac\n"
         "  if [[ $word == -* ]]; then\n"
         "    case \"$verb\" in\n";
  for (const Verb& verb : verbs) {
    std::vector<std::string> options;
    for (const Choice& option : verb.options) options.push_back(option.name);
    out << "      " << verb.name << ") COMPREPLY=($(compgen -W \"" << join(options) << "\" -- \"$word\")) ;;\n";
  }
  out << "    esac\n"
         "  else\n"
         "    compopt -o filenames 2>/dev/null\n"
         "    mapfile -t COMPREPLY < <(compgen -f -- \"$word\")\n"
         "  fi\n"
         "}\n"
         "complete -F _arete arete\n";
}

void write_zsh(std::ostream& out, const std::vector<Verb>& verbs) {
  const std::string special = "[]:";
  out << "#compdef arete\n"
         "_arete() {\n"
         "  if (( CURRENT == 2 )); then\n"
         "    local -a verbs=(";
  for (const Verb& verb : verbs) out << "\n      " << quoted(verb.name + ":") << quoted(verb.description, special);
  out << ")\n"
         "    _describe verb verbs\n"
         "    return\n"
         "  fi\n"
         "  local verb=$words[2]\n"
         "  shift words; (( CURRENT-- ))\n"
         "  case $verb in\n";
  for (const Verb& verb : verbs) {
    out << "    " << verb.name << ") _arguments";
    for (const Choice& option : verb.options) {
      out << " \\\n      " << quoted(option.name + "[") << quoted(option.description, special) << quoted("]");
      if (!option.values.empty())
        out << quoted(":value:(" + join(option.values) + ")");
      else if (option.takes_value)
        out << quoted(":value:_files");
    }
    out << " \\\n      '*:file:_files' ;;\n";
  }
  out << "  esac\n"
         "}\n"
         "_arete \"$@\"\n";
}

void write_fish(std::ostream& out, const std::vector<Verb>& verbs) {
  out << "# fish completion for arete\n";
  for (const Verb& verb : verbs) {
    out << "complete -c arete -f -n __fish_use_subcommand -a " << verb.name << " -d " << quoted(verb.description) << '\n';
    for (const Choice& option : verb.options) {
      out << "complete -c arete -n '__fish_seen_subcommand_from " << verb.name << "' -l " << option.name.substr(2);
      if (!option.values.empty())
        out << " -x -a " << quoted(join(option.values));
      else if (option.takes_value)
        out << " -r";
      out << " -d " << quoted(option.description) << '\n';
    }
  }
}

}  // namespace

std::string write_completion(const CLI::App& app, const std::string& shell) {
  std::ostringstream out;
  const std::vector<Verb> verbs = verbs_of(app);
  if (shell == "bash") write_bash(out, verbs);
  if (shell == "zsh") write_zsh(out, verbs);
  if (shell == "fish") write_fish(out, verbs);
  return out.str();
}

void add_completion(CLI::App& app) {
  const auto shell = std::make_shared<std::string>();
  CLI::App* verb = app.add_subcommand("completion", "Print the completion script of a shell")->group("Verbs");
  verb->add_option("SHELL", *shell, "bash, zsh or fish")->required()->check(CLI::IsMember({"bash", "zsh", "fish"}))->type_name("");
  verb->footer("Example:\n  arete completion bash > ~/.local/share/bash-completion/completions/arete");
  verb->callback([&app, shell] { std::cout << write_completion(app, *shell); });
}

}  // namespace arete::tools
