# SPDX-License-Identifier: BSD-3-Clause
# shellcheck shell=bash
# To be sourced by a script before it does anything: -h and --help print the comment at its head, and
# an option that is not in $known_options (a list of words) ends it with exit code 2.
for argument in "$@"; do
  case $argument in
    -h | --help)
      sed -n '/^[^#]/q; /^#!/d; /^# SPDX/d; s/^# \{0,1\}//p' "$0"
      exit 0
      ;;
    -*)
      case " ${known_options:-} " in
        *" $argument "*) ;;
        *)
          echo "$(basename "$0" .sh): unknown option $argument; see $0 --help" >&2
          exit 2
          ;;
      esac
      ;;
  esac
done
unset argument
