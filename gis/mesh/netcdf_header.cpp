// The NetCDF classic format specification, https://docs.unidata.ucar.edu/nug/current/file_format_specifications.html.
#include "gis/mesh/netcdf_header.h"

#include <cstdint>
#include <set>
#include <string>
#include <vector>

#include "gis/mesh/input_file.h"

namespace arete {
namespace {

constexpr std::uint32_t dimension_tag = 10, variable_tag = 11, attribute_tag = 12;
constexpr std::uint64_t longest_name = 256;  // NC_MAX_NAME
constexpr std::uint64_t most_variable_dimensions = 1024;

class Header {
 public:
  explicit Header(InputFile& file, int version) : file_(file), version_(version) {}

  void check() {
    count();  // of records
    list(dimension_tag, "dimensions", [&] {
      name(dimension_names_);
      lengths_.push_back(count());
    });
    attributes();
    std::set<std::string> names;
    list(variable_tag, "variables", [&] { variable(names); });
  }

 private:
  std::uint64_t big_endian(int bytes) {
    std::uint64_t value = 0;
    for (const std::byte byte : file_.take(static_cast<std::size_t>(bytes), "its header")) value = value << 8 | std::to_integer<std::uint64_t>(byte);
    return value;
  }
  std::uint64_t count() { return big_endian(version_ == 5 ? 8 : 4); }

  template <class Item>
  void list(std::uint32_t tag, const char* what, const Item& item) {
    const std::uint64_t found = big_endian(4), items = count();
    // Each takes 8 bytes and more.
    if ((found != tag && !(found == 0 && items == 0)) || items > file_.left() / 8)
      file_.fail_at_byte("holds no list of " + std::string(what) + ": tag " + std::to_string(found) + ", " + std::to_string(items) + " of them");
    for (std::uint64_t i = 0; i < items; ++i) item();
  }

  void name(std::set<std::string>& among) {
    const std::uint64_t length = count();
    if (length == 0 || length > longest_name) file_.fail_at_byte("holds a name of " + std::to_string(length) + " bytes");
    const auto bytes = file_.take(static_cast<std::size_t>((length + 3) / 4 * 4), "a name");
    const std::string name(reinterpret_cast<const char*>(bytes.data()), static_cast<std::size_t>(length));
    if (name.find('\0') != std::string::npos || !among.insert(name).second) file_.fail_at_byte("ends a name that is there twice, or ends early");
  }

  /// Its size in bytes.
  std::uint64_t type() {
    static constexpr std::uint64_t sizes[] = {0, 1, 1, 2, 4, 4, 8, 1, 2, 4, 8, 8};
    const std::uint64_t type = big_endian(4);
    if (type == 0 || type > (version_ == 5 ? 11u : 6u)) file_.fail_at_byte("names the type " + std::to_string(type) + ", which there is not");
    return sizes[type];
  }

  void attributes() {
    std::set<std::string> names;
    list(attribute_tag, "attributes", [&] {
      name(names);
      const std::uint64_t size = type(), values = count();
      if (values > file_.left() / size) file_.fail_at_byte("states " + std::to_string(values) + " values of an attribute");
      file_.skip((values * size + 3) / 4 * 4, "an attribute");
    });
  }

  void variable(std::set<std::string>& names) {
    name(names);
    const std::uint64_t dimensions = count();
    if (dimensions > most_variable_dimensions) file_.fail_at_byte("states " + std::to_string(dimensions) + " dimensions of a variable");
    std::uint64_t values = 1;
    bool records = false;
    for (std::uint64_t i = 0; i < dimensions; ++i) {
      const std::uint64_t id = count();
      if (id >= lengths_.size()) file_.fail_at_byte("names dimension " + std::to_string(id) + " of " + std::to_string(lengths_.size()));
      const std::uint64_t length = lengths_[id];
      records = records || length == 0;
      if (length != 0 && values > file_.size() / length) values = file_.size() + 1;
      else values *= length == 0 ? 1 : length;
    }
    attributes();
    const std::uint64_t size = type();
    count();  // of bytes, which old files state wrongly
    const std::uint64_t begin = big_endian(version_ == 1 ? 4 : 8);
    if (!records && (begin > file_.size() || values > (file_.size() - begin) / size))
      file_.fail_at_byte("places a variable behind the end of the file, at " + std::to_string(begin) + "; get it again");
  }

  InputFile& file_;
  int version_;
  std::set<std::string> dimension_names_;
  std::vector<std::uint64_t> lengths_;
};

}  // namespace

void check_netcdf_header(const std::string& path) {
  InputFile file(path);
  const std::string_view start = file.peek(4);
  if (start.size() < 4 || start.substr(0, 3) != "CDF") return;
  const int version = start[3];
  if (version != 1 && version != 2 && version != 5) return;
  file.skip(4, "its first word");
  Header(file, version).check();
}

}  // namespace arete
