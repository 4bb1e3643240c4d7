// SPDX-License-Identifier: Apache-2.0
#pragma once
// The command as two processes: one that works, and one that waits for it. Whatever the geometry kernel does to the
// first, the second says what happened in one diagnostic and removes what was left half-written.

namespace meso::cli {

/// Call once, first of all. Returns in the process that works; the other passes on signals, and ends as the first does:
/// with its exit code, or with GEOMETRY_CRASHED (LIMIT_MEMORY where the system killed it for memory). `in_json`: this
/// is said in an object on standard output, too. Costs a millisecond.
void stand_behind_wall(bool in_json);

/// From the working process: the answer has been printed, so nothing is to be added to standard output.
void tell_wall_answered();

}  // namespace meso::cli
