#include "core/support/file.h"

#include <cerrno>
#include <cstring>
#include <string>

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include "core/support/error.h"

namespace arete {

namespace {

std::string reason() { return std::strerror(errno); }

class Descriptor {
 public:
  explicit Descriptor(int value) : value_(value) {}
  ~Descriptor() {
    if (value_ >= 0) ::close(value_);
  }
  Descriptor(const Descriptor&) = delete;
  Descriptor& operator=(const Descriptor&) = delete;
  int get() const { return value_; }
  bool close() {
    const int value = value_;
    value_ = -1;
    return ::close(value) == 0;
  }

 private:
  int value_;
};

// Removes the temporary file unless it was renamed.
struct Temporary {
  std::string path;
  ~Temporary() {
    if (!path.empty()) ::unlink(path.c_str());
  }
};

bool write_all(int file, std::span<const std::byte> bytes) {
  while (!bytes.empty()) {
    const ssize_t written = ::write(file, bytes.data(), bytes.size());
    if (written < 0 && errno == EINTR) continue;
    if (written <= 0) return false;
    bytes = bytes.subspan(static_cast<std::size_t>(written));
  }
  return true;
}

void flush_folder(const std::filesystem::path& folder) {
  const Descriptor descriptor(::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC));
  if (descriptor.get() >= 0) ::fsync(descriptor.get());  // some file systems cannot; the file itself is flushed
}

[[noreturn]] void refuse_existing(const std::filesystem::path& path) {
  throw Error(ErrorKind::disk, path.string() + " exists already: choose another name or give --overwrite");
}

// Gives the temporary file its name. A link refuses to replace what appeared meanwhile; a rename replaces.
bool publish(Temporary& temporary, const std::filesystem::path& path, bool overwrite) {
  if (!overwrite) {
    if (::link(temporary.path.c_str(), path.c_str()) == 0) return true;
    if (errno == EEXIST) refuse_existing(path);
    const bool no_links = errno == EPERM || errno == EOPNOTSUPP || errno == ENOSYS;  // as on FAT
    if (!no_links) return false;
    if (std::filesystem::exists(path)) refuse_existing(path);
  }
  if (::rename(temporary.path.c_str(), path.c_str()) != 0) return false;
  temporary.path.clear();
  return true;
}

}  // namespace

std::vector<std::byte> read_file(const std::filesystem::path& path) {
  const Descriptor file(::open(path.c_str(), O_RDONLY | O_CLOEXEC));
  if (file.get() < 0) throw Error(ErrorKind::input, "cannot open " + path.string() + ": " + reason());
  struct stat status {};
  if (::fstat(file.get(), &status) != 0 || !S_ISREG(status.st_mode))
    throw Error(ErrorKind::input, "cannot read " + path.string() + ": not a regular file");
  std::vector<std::byte> bytes(static_cast<std::size_t>(status.st_size));
  std::size_t done = 0;
  while (done < bytes.size()) {
    const ssize_t got = ::read(file.get(), bytes.data() + done, bytes.size() - done);
    if (got < 0 && errno == EINTR) continue;
    if (got < 0) throw Error(ErrorKind::disk, "cannot read " + path.string() + ": " + reason());
    if (got == 0) break;  // it shrank meanwhile
    done += static_cast<std::size_t>(got);
  }
  bytes.resize(done);
  return bytes;
}

void write_file_atomically(const std::filesystem::path& path, std::span<const std::byte> bytes, bool overwrite) {
  const std::filesystem::path folder = path.has_parent_path() ? path.parent_path() : std::filesystem::path(".");
  if (std::filesystem::is_directory(path)) throw Error(ErrorKind::disk, path.string() + " is a folder: expected the name of a file");
  if (!overwrite && std::filesystem::exists(path)) refuse_existing(path);

  std::string name = (folder / ("." + path.filename().string() + ".XXXXXX")).string();
  Descriptor file(::mkostemp(name.data(), O_CLOEXEC));
  if (file.get() < 0) throw Error(ErrorKind::disk, "cannot write into folder " + folder.string() + ": " + reason());
  Temporary temporary{name};

  const mode_t mask = ::umask(0);
  ::umask(mask);
  if (!write_all(file.get(), bytes) || ::fchmod(file.get(), 0666 & ~mask) != 0 || ::fsync(file.get()) != 0 || !file.close())
    throw Error(ErrorKind::disk, "cannot write " + path.string() + ": " + reason());

  if (!publish(temporary, path, overwrite)) throw Error(ErrorKind::disk, "cannot write " + path.string() + ": " + reason());
  flush_folder(folder);
}

}  // namespace arete
