#!/bin/sh
# Checks Cargo.lock against the security advisories of RustSec with cargo-deny or cargo-audit. Uses the newest database if it can be
# fetched, otherwise one that was fetched before. Only an advisory is a failure; a check that is not possible is reported.
set -eu
cd "$(dirname "$0")/.."
home=${CARGO_HOME:-$HOME/.cargo}

not_checked() { echo "advisories: not checked ($1)"; exit 0; }

# TOOL DATABASE: reports which database is used, or that there is none.
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
  # cargo-audit fetches and checks in one step; offline it checks with the available database.
  if git ls-remote --exit-code https://github.com/RustSec/advisory-db HEAD >/dev/null 2>&1; then fetched=yes; fi
  database cargo-audit "$home/advisory-db"
  if [ "$fetched" = yes ]; then cargo audit; else cargo audit --no-fetch; fi
else
  not_checked 'neither cargo-deny nor cargo-audit is installed: cargo install --locked cargo-deny'
fi
