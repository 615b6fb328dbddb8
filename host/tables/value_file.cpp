#include "host/tables/value_file.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <set>

#include "host/tables/table.h"
#include "mica/error.h"

namespace mica::host {
namespace {

constexpr char kPartKey[] = "mica table part";  // first in the line
constexpr int kPartVersion = 1;
constexpr std::size_t kHashDigits = 32, kLongestHeader = 1 << 20;

std::string part_header(const TablePart& part) {
  const nlohmann::ordered_json json = {{kPartKey, kPartVersion},  {"shard", part.shard},
                                       {"shards", part.shards},   {"first", part.first},
                                       {"count", part.count},     {"rows", part.rows},
                                       {"columns", part.columns}, {"identity", part.identity}};
  return json.dump(-1, ' ', false, nlohmann::ordered_json::error_handler_t::replace) + "\n";
}

/// A part's file: what its header says, and where its values begin.
struct PartFile {
  std::string path;
  TablePart part;
  std::string header;
};

/// Throws FileError.
PartFile open_part(const std::string& path) {
  std::ifstream stream(path, std::ios::binary);
  if (!stream || std::filesystem::is_directory(path))
    throw FileError(path + ": no such file, or it cannot be read");
  PartFile file{path, {}, std::string(kLongestHeader, '\0')};
  stream.read(file.header.data(), static_cast<std::streamsize>(file.header.size()));
  file.header.resize(static_cast<std::size_t>(stream.gcount()));
  file.header.resize(std::min(file.header.find('\n'), file.header.size() - 1) + 1);
  try {
    const auto json = nlohmann::json::parse(file.header);
    if (json.at(kPartKey) != kPartVersion) throw FileError(path + ": is a part of another version");
    TablePart& part = file.part;
    part.shard = json.at("shard"), part.shards = json.at("shards");
    part.first = json.at("first"), part.count = json.at("count");
    part.rows = json.at("rows"), part.columns = json.at("columns");
    part.identity = json.at("identity").get<std::map<std::string, std::string>>();
  } catch (const nlohmann::json::exception&) {
    throw FileError(path + ": is no part of a table, or cut short");
  }
  const std::uint64_t expected = file.header.size() + file.part.value_bytes() + kHashDigits;
  if (const std::uint64_t found = std::filesystem::file_size(path); found != expected)
    throw FileError(
        fmt::format("{}: is cut short or damaged: found {} bytes, expected {}", path, found, expected));
  return file;
}

std::vector<PartFile> open_parts(const std::vector<std::string>& paths) {
  std::vector<PartFile> files;
  std::vector<std::string> problems;
  for (const std::string& path : paths) try {
      files.push_back(open_part(path));
    } catch (const FileError& error) {
      problems.emplace_back(error.what());
    }
  if (!problems.empty()) throw FileError(fmt::format("cannot join: {}", fmt::join(problems, "\n  ")));
  return files;
}

/// What tells tables apart, as text by name.
std::map<std::string, std::string> identity_of(const TablePart& part) {
  std::map<std::string, std::string> identity = part.identity;
  identity["rows"] = fmt::format("{}", part.rows);
  identity["columns"] = fmt::format("{}", part.columns);
  return identity;
}

std::string difference(const std::map<std::string, std::string>& found,
                       const std::map<std::string, std::string>& expected) {
  for (const auto& [name, value] : expected) {
    const auto other = found.find(name);
    if (other == found.end() || other->second != value)
      return fmt::format("{} is {} instead of {}", name, other == found.end() ? "nothing" : other->second,
                         value);
  }
  return found.size() == expected.size() ? "" : "it says more of itself";
}

/// Sorts parts by their rows, each of which has to be there once.
void check_parts(std::vector<PartFile>* files) {
  if (files->empty()) throw UsageError("cannot join: found no part");
  std::map<std::map<std::string, std::string>, int> counts;
  for (const PartFile& file : *files) ++counts[identity_of(file.part)];
  const auto& expected = std::max_element(counts.begin(), counts.end(), [](const auto& a, const auto& b) {
                           return a.second < b.second;
                         })->first;
  std::vector<std::string> problems;
  std::vector<PartFile> own;
  for (PartFile& file : *files) {
    const std::string other = difference(identity_of(file.part), expected);
    if (other.empty())
      own.push_back(std::move(file));
    else
      problems.push_back(fmt::format("{}: is a part of another table: {}", file.path, other));
  }
  std::stable_sort(own.begin(), own.end(),
                   [](const PartFile& a, const PartFile& b) { return a.part.first < b.part.first; });
  std::uint64_t next = 0;
  const PartFile* before = nullptr;
  for (const PartFile& file : own) {
    const std::uint64_t end = file.part.first + file.part.count;
    if (file.part.first > next)
      problems.push_back(fmt::format("rows {}-{} are in no part", next, file.part.first - 1));
    if (file.part.first < next)
      problems.push_back(fmt::format("{}: rows {}-{} are in {} as well", file.path, file.part.first,
                                     std::min(end, next) - 1, before->path));
    if (end > next) next = end, before = &file;
  }
  if (const std::uint64_t rows = own.front().part.rows; next < rows)
    problems.push_back(fmt::format("rows {}-{} are in no part", next, rows - 1));
  if (!problems.empty()) throw UsageError(fmt::format("cannot join: {}", fmt::join(problems, "\n  ")));
  *files = std::move(own);
}

/// Appends a part's values; throws FileError unless they are those that its hash is of.
void copy_values(const PartFile& file, ValueFile* output) {
  std::ifstream stream(file.path, std::ios::binary);
  stream.seekg(static_cast<std::streamoff>(file.header.size()));
  Hash hash;
  hash.add(file.header);
  std::vector<float> values;
  for (std::uint64_t rest = file.part.value_bytes() / sizeof(float); rest > 0 && stream;
       rest -= values.size()) {
    values.resize(std::min<std::uint64_t>(rest, 1 << 18));
    const std::size_t bytes = values.size() * sizeof(float);
    stream.read(reinterpret_cast<char*>(values.data()), static_cast<std::streamsize>(bytes));
    hash.add(values.data(), bytes);
    output->append(values);
  }
  std::string digits(kHashDigits, '\0');
  stream.read(digits.data(), static_cast<std::streamsize>(digits.size()));
  if (!stream || digits != hash.digits())
    throw FileError(
        fmt::format("cannot join: {}: is damaged: its values are not those that were written", file.path));
}

}  // namespace

ValueFile::ValueFile(const std::string& path, std::size_t rows, std::size_t columns)
    : file_(path), is_part_(false) {
  file_.append(npy_header(rows, columns));
}

ValueFile::ValueFile(const std::string& path, const TablePart& part) : file_(path), is_part_(true) {
  const std::string header = part_header(part);
  hash_.add(header);
  file_.append(header);
}

void ValueFile::append(const std::vector<float>& values) {
  const std::size_t bytes = values.size() * sizeof(float);
  if (is_part_) hash_.add(values.data(), bytes);
  file_.append(values.data(), bytes);
}

void ValueFile::finish() {
  if (is_part_) file_.append(hash_.digits());
  file_.finish();
}

std::uint64_t join_tables(const std::vector<std::string>& paths, const std::string& output) {
  std::vector<PartFile> files = open_parts(paths);
  check_parts(&files);
  const TablePart& first = files.front().part;
  ValueFile joined(output, first.rows, first.columns);
  for (const PartFile& file : files) copy_values(file, &joined);
  joined.finish();
  return first.rows;
}

}  // namespace mica::host
