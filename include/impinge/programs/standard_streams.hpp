#pragma once
// Standard streams that may be gone: closed, a full disk, a reader that has gone.

namespace impinge {

/// Opens closed standard streams, so that no file of a run becomes one of them, and lets standard output drop what it
/// cannot write: a run goes on without. A file beyond its largest size (`ulimit -f`) is an error of the
/// write, not a signal. To be called first in main.
void prepare_streams();

/// Writes out what standard output still holds. False where some of it could not be written; tells the reason on
/// standard error, once.
bool flush_output(const char* program);

}  // namespace impinge
