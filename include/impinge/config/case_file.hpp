#pragma once
// Case files (TOML): reading them into declared keys, and writing the keys as text.

#include <functional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "impinge/config/key.hpp"

namespace impinge {

/// A file's name and its text.
using NamedText = std::pair<std::string, std::string>;

/// What the key `include` does, which the files have beside the declared keys.
constexpr std::string_view include_doc = "takes that file's values as defaults; FILE is relative to the case file";

/// What is wrong with a text that files shall hold and give back, XML among them: it is empty, too long, not UTF-8, or
/// has control characters. Nothing if all is well.
std::string text_problem(std::string_view text);

/// What is wrong with a path in a case file: it has words of a shell, which nobody replaces there. Nothing if all is
/// well.
std::string path_problem(std::string_view path);

/// The case file followed by the files it includes (key `include`, relative to the including file), as texts.
/// Reads the disk; not collective. Throws InputError (missing file, include cycle) that also lists what else is wrong
/// in the files it could read, by their `keys`.
std::vector<NamedText> load_files(const std::string& path, Keys& keys);

/// Appends the files that the tables of a list name by a key, relative to the file that names them, behind the files:
/// those whose names `counts` says yes to. What cannot be read, or is larger than `largest` bytes, is left out. Reads
/// the disk; not collective.
void load_named_files(std::vector<NamedText>& files, std::string_view list, std::string_view key,
                      const std::function<bool(std::string_view)>& counts, std::size_t largest);

/// The path of a file that another names [as it is given to load_named_files].
std::string path_of_named(const std::string& naming_file, const std::string& name);

/// Reads the files and the `settings` ("key=value") into the keys' settings and checks each value by itself; mistakes
/// stay in `keys`. Earlier files override later ones, a later setting overrides all. A list of tables is taken whole,
/// from one file; settings can change the keys of its tables. False if a file is not TOML: what is absent is no mistake
/// then. Call it once.
bool read_files(Keys& keys, const std::vector<NamedText>& files, const std::vector<std::string>& settings);

/// All keys that apply with their values, as one TOML text that reads back to the same settings.
std::string resolved_text(const Keys& keys);

/// Every key with type, unit, range, default and doc line, as a text for the terminal. Gives each list one table.
std::string describe(Keys& keys);

}  // namespace impinge
