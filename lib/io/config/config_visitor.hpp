// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstddef>
#include <functional>
#include <initializer_list>
#include <string>
#include <utility>
#include <vector>

namespace orchard::io {

/// Description of one configuration key.
struct ConfigKey {
  const char* name = "";
  const char* unit = "";
  const char* doc = "";
  const char* former = "";  ///< the key's name in older files and logs; "": it had none
  bool is_expert = false;   ///< --print-config shows it only with --all, or when it is not default
};

/// A list of numbers in a configuration struct: of fixed size, or resizable through `values`.
struct NumberList {
  double* data = nullptr;
  std::size_t size = 0;
  std::vector<double>* values = nullptr;  ///< null: the size is fixed
};

/// Interface for reading or printing a configuration. Each module presents the keys of its struct
/// by `describe(visitor, struct)`; readers and printers implement the on_ functions. The modules
/// therefore do not depend on YAML, nor the YAML code on the modules.
class ConfigVisitor {
 public:
  virtual ~ConfigVisitor() = default;

  /// Marks the next key, or all keys of the next section, as expert keys.
  ConfigVisitor& expert() {
    is_next_expert_ = true;
    return *this;
  }

  /// Gives the next key, which is no section, the name that it had before.
  ConfigVisitor& was(const char* former) {
    former_ = former;
    return *this;
  }

  void number(const char* key, double& value, double lo, double hi, const char* unit,
              const char* doc) {
    on_number(next(key, unit, doc), value, lo, hi);
  }

  void integer(const char* key, int& value, int lo, int hi, const char* unit, const char* doc) {
    on_integer(next(key, unit, doc), value, lo, hi);
  }

  void flag(const char* key, bool& value, const char* doc) { on_flag(next(key, "", doc), value); }

  void text(const char* key, std::string& value, const char* doc) {
    on_text(next(key, "", doc), value);
  }

  /// `names` in the order of the enumerators, which must count from 0.
  template <class Enum>
  void choice(const char* key, Enum& value, std::initializer_list<const char*> names,
              const char* doc) {
    int index = static_cast<int>(value);
    on_choice(next(key, "", doc), index, names);
    value = static_cast<Enum>(index);
  }

  template <std::size_t N>
  void numbers(const char* key, std::array<double, N>& values, double lo, double hi,
               const char* unit, const char* doc) {
    on_numbers(next(key, unit, doc), {values.data(), N, nullptr}, lo, hi);
  }

  void numbers(const char* key, std::vector<double>& values, double lo, double hi, const char* unit,
               const char* doc) {
    on_numbers(next(key, unit, doc), {values.data(), values.size(), &values}, lo, hi);
  }

  template <class Section>
  void section(const char* key, Section& value, const char* doc) {
    const bool was_expert = is_section_expert_;
    const ConfigKey described = next(key, "", doc);
    is_section_expert_ = described.is_expert;
    on_section(described, [this, &value] { describe(*this, value); });
    is_section_expert_ = was_expert;
  }

  /// Checks a condition between keys; `why` completes the message "key = value: ...".
  void check(bool holds, const char* key, const char* why) {
    if (!holds) on_broken_check(key, why);
  }

 private:
  virtual void on_number(const ConfigKey& key, double& value, double lo, double hi) = 0;
  virtual void on_integer(const ConfigKey& key, int& value, int lo, int hi) = 0;
  virtual void on_flag(const ConfigKey& key, bool& value) = 0;
  virtual void on_text(const ConfigKey& key, std::string& value) = 0;
  virtual void on_choice(const ConfigKey& key, int& index,
                         std::initializer_list<const char*> names) = 0;
  virtual void on_numbers(const ConfigKey& key, const NumberList& list, double lo, double hi) = 0;
  /// `visit` presents the keys of the section.
  virtual void on_section(const ConfigKey& key, const std::function<void()>& visit) = 0;
  virtual void on_broken_check(const char* key, const char* why) = 0;

  ConfigKey next(const char* key, const char* unit, const char* doc) {
    return {key, unit, doc, std::exchange(former_, ""),
            std::exchange(is_next_expert_, false) || is_section_expert_};
  }

  const char* former_ = "";
  bool is_next_expert_ = false;
  bool is_section_expert_ = false;
};

/// Presents all sections of a configuration to a visitor.
using ConfigSchema = std::function<void(ConfigVisitor&)>;

}  // namespace orchard::io
