#pragma once

#include <memory>
#include <string>
#include <vector>

#include "mica/query.h"
#include "mica/span.h"
#include "mica/surface.h"
#include "mica/version.h"

namespace mica::host {
class MethodRegistry;
}

MICA_BEGIN_NAMESPACE

/// A number that a method takes from jobs, the command line and callers by its key.
struct MethodNumber {
  std::string key, help;
  double value = 0;          ///< unless it is given
  double low = 0, high = 1;  ///< what it may be, ends included
};

/// A method of your own: in a registry it answers under its name wherever the library's methods do, in
/// evaluators, jobs, `mica eval`, benchmarks and the selftest.
class MICA_API Method {
 public:
  virtual ~Method();

  virtual std::string name() const = 0;     ///< a word of lower-case letters
  virtual std::string summary() const = 0;  ///< one line for lists
  virtual std::vector<MethodNumber> numbers() const { return {}; }
  /// Interpolations that it is right for.
  virtual bool takes(Interpolation) const { return true; }
  /// Whether it answers where the half vector turns or the lobe is not round; else such queries are refused.
  virtual bool takes_first_order() const { return false; }
  /// Memory that it needs beside the map, bytes.
  virtual std::size_t bytes(int /*width*/, int /*height*/) const { return 0; }
  /// What it promises: an error relative to the map's density, at most. 0: it approximates, and promises
  /// nothing.
  virtual double promised_error() const { return 0; }

  /// Answers for one map.
  class MICA_API Densities {
   public:
    virtual ~Densities();
    /// D of each query, finite and >= 0; depends on the query alone. May be called by several threads.
    virtual void evaluate(Span<const Query> queries, Span<float> densities) const = 0;
  };
  /// @param numbers in the order of numbers(). Throw UsageError for what it does not take.
  virtual std::unique_ptr<Densities> make(const NormalMap& map, const std::vector<double>& numbers) const = 0;
};

/// What a method can be asked for.
struct MethodInfo {
  std::string name;
  std::string summary;           ///< one line
  bool needs_map = true;         ///< else it has glints of its own
  bool has_densities = true;     ///< Evaluator takes it
  bool has_brdf = false;         ///< Brdf takes it
  bool keeps_tolerance = false;  ///< it has the setting `tolerance`
};

/// The methods that there are, by name. A value: add yours to a copy, and hand that on.
class MICA_API Methods {
 public:
  Methods();  ///< those of the library

  /// Throws UsageError for no method, and for a name that is taken or no word.
  void add(std::shared_ptr<const Method> method);
  std::vector<std::string> names() const;
  /// Throws UsageError for a name that is not there.
  MethodInfo info(const std::string& name) const;
  /// Every setting of a method in words, a line each. Throws UsageError for a name that is not there.
  std::vector<std::string> settings_of(const std::string& name) const;

  /// For the library itself.
  const std::shared_ptr<const host::MethodRegistry>& implementation() const { return implementation_; }

 private:
  std::shared_ptr<const host::MethodRegistry> implementation_;
};

/// `mica` with these methods: what the installed command does for argv, and its exit code.
MICA_API int run_command(int argc, const char* const* argv, const Methods& methods = {});

/// The same as the whole program of a process: its log goes to standard error, and SIGINT and SIGTERM end it
/// as they end the installed command. Call it once, from `main`.
MICA_API int run_program(int argc, const char* const* argv, const Methods& methods = {});

MICA_END_NAMESPACE
