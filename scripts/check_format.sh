#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Fails if a tracked C++ file is not laid out as .clang-format says. To repair one: clang-format-14 -i FILE
set -euo pipefail
cd "$(dirname "$0")/.."
# Version 14 by name: other versions break lines differently.
git ls-files -z '*.cpp' '*.hpp' '*.h' '*.c' | xargs -0 -r clang-format-14 --dry-run -Werror
echo "check_format: $(git ls-files '*.cpp' '*.hpp' '*.h' '*.c' | wc -l) files are in order"
