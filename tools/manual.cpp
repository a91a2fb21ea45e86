#include "tools/manual.h"

#include <algorithm>
#include <cctype>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <sstream>

#include "core/support/error.h"
#include "tools/help.h"

namespace arete::tools {
namespace {

/// Text as roff shows it: backslashes and hyphens kept, no line that begins with a control character.
std::string roff(const std::string& text) {
  std::string safe;
  for (const char c : text) {
    const bool line_start = safe.empty() || safe.back() == '\n';
    if (line_start && (c == '.' || c == '\'')) safe += "\\&";
    if (c == '\\')
      safe += "\\e";
    else if (c == '-')
      safe += "\\-";
    else
      safe += c;
  }
  return safe;
}

std::string upper(std::string text) {
  std::transform(text.begin(), text.end(), text.begin(), [](unsigned char c) { return std::toupper(c); });
  return text;
}

void write_heading(std::ostream& out, const std::string& page, const std::string& summary) {
  out << ".TH " << roff(upper(page)) << " 1 \"\" \"arete " << ARETE_VERSION << "\" \"Arete manual\"\n.SH NAME\n"
      << roff(page) << " \\- " << roff(summary) << '\n';
}

/// "--factor N" of an option, "IN" of an argument.
std::string usage_of(const CLI::Option& option) {
  if (!option.nonpositional()) return option.get_name(true);
  std::string names;
  for (const std::string& name : option.get_snames()) names += (names.empty() ? "-" : ", -") + name;
  for (const std::string& name : option.get_lnames()) names += (names.empty() ? "--" : ", --") + name;
  const std::string type = readable_type(option);
  return type.empty() ? names : names + ' ' + type;
}

void write_options(std::ostream& out, const CLI::App& app, bool positional) {
  for (const CLI::Option* option : app.get_options()) {
    if (option->nonpositional() == positional || option->get_group().empty()) continue;
    out << ".TP\n.B " << roff(usage_of(*option)) << '\n' << roff(option->get_description()) << '\n';
  }
}

void write_exit_codes(std::ostream& out) {
  const std::pair<const char*, const char*> codes[] = {
      {"0", "the work was done"},
      {"2", "the command line makes no sense"},
      {"3", "an input is missing or damaged, or the inputs do not fit each other"},
      {"4", "an input or output format that is not supported"},
      {"5", "writing or reading failed, the output exists already, or its folder is missing or read-only"},
      {"6", "the work does not fit in the memory that --memory allows"},
      {"7", "interrupted; the output was not written"},
      {"8", "a dictionary or another of Arete's own files fails its checksum"},
      {"70", "a fault of Arete itself"}};
  out << ".SH EXIT STATUS\n";
  for (const auto& [code, meaning] : codes) out << ".TP\n.B " << code << '\n' << roff(meaning) << '\n';
}

std::vector<const CLI::App*> visible_verbs(const CLI::App& app) {
  return app.get_subcommands([](const CLI::App* verb) { return !verb->get_group().empty(); });
}

void write_file(const std::filesystem::path& path, const std::string& text) {
  std::ofstream file(path);
  file << text;
  file.close();
  if (!file) throw Error(ErrorKind::disk, path.string() + ": cannot write the manual page; is the folder there and writable?");
}

}  // namespace

std::string write_manual(const CLI::App& app) {
  std::ostringstream out;
  write_heading(out, "arete", app.get_description());
  out << ".SH SYNOPSIS\n.B arete\n.I VERB\n[options] INPUT... OUTPUT\n.SH VERBS\n";
  for (const CLI::App* verb : visible_verbs(app))
    out << ".TP\n.BR arete\\-" << roff(verb->get_name()) << " (1)\n" << roff(verb->get_description()) << '\n';
  out << ".SH OPTIONS\n";
  write_options(out, app, false);
  out << ".SH FILES\nAny raster that GDAL opens is an input, also /vsizip, /vsicurl and VRT mosaics. Elevations are read in "
         "metres. An output appears under its name only when it is complete; one that exists is replaced only with "
         "\\-\\-overwrite.\n";
  write_exit_codes(out);
  return out.str();
}

std::string write_manual(const CLI::App& app, const CLI::App& verb) {
  std::ostringstream out;
  const std::string name = app.get_name() + '-' + verb.get_name();
  write_heading(out, name, verb.get_description());
  out << ".SH SYNOPSIS\n.B " << roff(app.get_name() + ' ' + verb.get_name()) << "\n[options]";
  for (const CLI::Option* option : verb.get_options())
    if (!option->nonpositional()) out << ' ' << roff(option->get_required() ? usage_of(*option) : '[' + usage_of(*option) + ']');
  out << "\n.SH ARGUMENTS\n";
  write_options(out, verb, true);
  out << ".SH OPTIONS\n";
  write_options(out, verb, false);
  if (!verb.get_footer().empty()) {
    const std::string footer = verb.get_footer();
    out << ".SH EXAMPLE\n.nf\n" << roff(footer.substr(footer.find('\n') + 1)) << "\n.fi\n";
  }
  write_exit_codes(out);
  out << ".SH SEE ALSO\n.BR arete (1)\n";
  return out.str();
}

void add_manual(CLI::App& app) {
  struct Options {
    std::string verb, folder;
  };
  const auto options = std::make_shared<Options>();
  CLI::App* man = app.add_subcommand("man", "Print the manual page of the command or of a verb, for man -l -");
  man->group("");
  man->add_option("VERB", options->verb, "The verb");
  man->add_option("--all", options->folder, "Write the pages of the command and of every verb into this folder")->type_name("FOLDER");
  man->callback([&app, options] {
    if (!options->folder.empty()) {
      write_file(std::filesystem::path(options->folder) / "arete.1", write_manual(app));
      for (const CLI::App* verb : visible_verbs(app))
        write_file(std::filesystem::path(options->folder) / ("arete-" + verb->get_name() + ".1"), write_manual(app, *verb));
      return;
    }
    if (options->verb.empty()) {
      std::cout << write_manual(app);
      return;
    }
    for (const CLI::App* verb : visible_verbs(app))
      if (verb->get_name() == options->verb) {
        std::cout << write_manual(app, *verb);
        return;
      }
    throw Error(ErrorKind::usage, "no manual page for '" + options->verb + "': not a verb; see 'arete --help'");
  });
}

}  // namespace arete::tools
