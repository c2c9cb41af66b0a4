#!/bin/sh
# Extracts a program from a document: the fenced block after the line <!-- file: NAME -->.
# Usage: scripts/extract.sh DOCUMENT NAME >PROGRAM
set -eu
awk -v name="$2" '
  $0 == "<!-- file: " name " -->" { found = 1; next }
  found && /^```/ { if (inside) exit; inside = 1; next }
  inside { print; lines++ }
  END { exit lines == 0 }
' "$1" || { echo "$1 has no block for $2" >&2; exit 1; }
