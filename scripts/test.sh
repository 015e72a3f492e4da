#!/usr/bin/env bash
# Installs what is missing, builds everything, runs every test.
#
#   scripts/test.sh [ARGUMENTS OF CTEST]     such as: scripts/test.sh -R Gsab

# shellcheck source=scripts/common.sh
source "$(dirname "${BASH_SOURCE[0]}")/common.sh"

"$root/scripts/setup.sh" --tests
ctest --test-dir "$build" --parallel "$(nproc)" --output-on-failure --no-tests=error "$@"
