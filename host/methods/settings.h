#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "host/base/glints_description.h"
#include "host/base/words.h"

namespace mica::host {

/// The numbers that a setting takes; its low end may be excluded.
struct SettingRange {
  double low, high;
  bool open_low = false;
};

/// Who asks for settings: a job's table, or a single call (the command line, the library, Python). They have
/// different words for a few of them.
enum class SettingSource { job, call };

/// What reads, lists or prints the settings of a method. Every setting has a key and a line of help, and
/// stays as it is where the source does not name it.
class SettingVisitor {
 public:
  virtual ~SettingVisitor() = default;
  virtual SettingSource source() const = 0;

  virtual void number(const char* key, const char* help, double& value, const SettingRange& range) = 0;
  virtual void whole(const char* key, const char* help, int& value, int low, int high) = 0;
  virtual void seed(const char* key, const char* help, std::uint32_t& value) = 0;
  /// One number, which stands for both, or two.
  virtual void one_or_two(const char* key, const char* help, Eigen::Vector2d& value,
                          const SettingRange& range) = 0;
  /// @param chosen index into `words`.
  virtual void word(const char* key, const char* help, int& chosen,
                    const std::vector<std::string>& words) = 0;
  /// Up to `most` colours, each channel within [0, 1]. Jobs have them.
  virtual void colors(const char*, const char*, std::vector<Eigen::Vector3d>&, std::size_t /*most*/) {}
  /// A file of a table of files. Jobs have them.
  virtual void file(const char* /*table*/, const char* /*key*/, const char*, std::string&) {}

  /// One of the words of an enum.
  template <typename Enum>
  void choice(const char* key, const char* help, Enum& value) {
    const std::vector<std::string> words = list_words<Enum>();
    int chosen = static_cast<int>(std::find(words.begin(), words.end(), word_of(value)) - words.begin());
    word(key, help, chosen, words);
    value = Words<Enum>::all[chosen].value;
  }
};

/// Settings of one method, carried whole from a job, a call or the command line to its constructor.
class MethodSettings {
 public:
  virtual ~MethodSettings() = default;
  virtual void visit(SettingVisitor&) {}
  virtual std::unique_ptr<MethodSettings> clone() const = 0;

  /// What its settings contradict: the key, and what was found and expected; two empty texts when all is
  /// well.
  struct Problem {
    std::string key, message;
  };
  virtual Problem problem() const { return {}; }
  /// Where its glints are not those of a map.
  virtual const GlintsDescription* glints() const { return nullptr; }

  /// The roughness that the settings themselves have, where it is not the material's.
  virtual std::optional<double> own_roughness() const { return std::nullopt; }

  std::optional<double> tolerance;  ///< relative error asked for; default: the method's own
};

/// Settings that are `Values`, a plain struct.
template <typename Derived>
class SettingsOf : public MethodSettings {
 public:
  std::unique_ptr<MethodSettings> clone() const override {
    return std::make_unique<Derived>(static_cast<const Derived&>(*this));
  }
};

/// Settings of a method that has none.
class NoSettings : public SettingsOf<NoSettings> {};

/// The settings in words, "masking exact, elements 2": alike for those that make the same.
std::string describe(const MethodSettings& settings);

/// Settings given by key as texts ("elements" -> "2"). Keys that the method does not know stay unread.
/// Throws UsageError, which names the key, for a value that is wrong.
using SettingTexts = std::vector<std::pair<std::string, std::string>>;
void read_settings(const SettingTexts& texts, MethodSettings* settings);

/// One setting as lists and options show it.
struct SettingEntry {
  std::string key, help, value, type;
  std::vector<std::string> words;  ///< that it takes; empty: numbers
};
std::vector<SettingEntry> list_settings(const MethodSettings& settings);

}  // namespace mica::host
