#!/bin/sh
# Checks Cargo.lock against the security advisories of RustSec with cargo-deny or cargo-audit: with the newest database where
# it can be fetched, else with one that was fetched before. Fails for an advisory alone; what cannot be checked is reported.
set -eu
cd "$(dirname "$0")/.."
home=${CARGO_HOME:-$HOME/.cargo}

not_checked() { echo "advisories: not checked ($1)"; exit 0; }

# TOOL DATABASE: says how old the database is, or that there is none.
database() {
  if [ "$fetched" = yes ]; then
    echo "advisories: checked by $1 with the newest database"
  elif [ -d "$2" ] && [ -n "$(ls -A "$2")" ]; then
    echo "advisories: checked offline by $1 with the database in $2"
  else
    not_checked 'the database cannot be fetched without a network, and none was fetched before'
  fi
}

fetched=no
if command -v cargo-deny >/dev/null; then
  if cargo deny fetch db >/dev/null 2>&1; then fetched=yes; fi
  database cargo-deny "$home/advisory-dbs"
  cargo deny --locked check --disable-fetch advisories
elif command -v cargo-audit >/dev/null; then
  # It fetches and checks at once; offline it checks what is there.
  if git ls-remote --exit-code https://github.com/RustSec/advisory-db HEAD >/dev/null 2>&1; then fetched=yes; fi
  database cargo-audit "$home/advisory-db"
  if [ "$fetched" = yes ]; then cargo audit; else cargo audit --no-fetch; fi
else
  not_checked 'neither cargo-deny nor cargo-audit is installed: cargo install --locked cargo-deny'
fi
