#pragma once
// Memory that is still free. Linux; where the system does not say, infinity. Nothing here is collective.

#include <string>
#include <string_view>

namespace impinge {

/// The number behind "name" in a text of lines "name: number unit" or "name number", as in files of /proc and of
/// control groups; infinity where there is none.
double number_behind(std::string_view name, std::string_view text);

/// What the processes of this node may still take together [bytes]: physical memory that is available, and what this
/// process' control groups (a container's or a batch job's limit) leave of it.
double free_memory_of_node();

/// What this process may still take by its own limit (`ulimit -v`) [bytes].
double free_memory_of_process();

/// "380 MB", "1.25 GB".
std::string bytes_text(double bytes);

}  // namespace impinge
