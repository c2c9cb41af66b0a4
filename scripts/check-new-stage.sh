#!/bin/sh
# A new stage changes no other crate: adds one to a copy of the workspace, as CONTRIBUTING.md says, and checks that the tests of the
# contract, `posecut help` and experiments find it.
set -eu
cd "$(dirname "$0")/.."
place=$PWD/target/ci/new-stage
copy=$place/copy
rm -rf "$copy"
mkdir -p "$copy"
# With their times, so that what was built before is not built again.
git ls-files -z | tar --null --files-from=- -cf - | tar -xf - -C "$copy"

# The smallest stage under another name.
cp -R "$copy/crates/oracle" "$copy/crates/echo"
find "$copy/crates/echo" -type f -exec sed -i 's/oracle/echo/g' {} +

# What was built for the workspace is what the copy needs, except for crates that contain the path of the workspace. What Cargo writes in
# place is copied, the rest linked.
built=${CARGO_TARGET_DIR:-target}/release
rm -rf "$place/target"
mkdir -p "$place/target/release"
for folder in deps build; do [ ! -d "$built/$folder" ] || cp -al "$built/$folder" "$place/target/release/"; done
[ ! -d "$built/.fingerprint" ] || cp -a "$built/.fingerprint" "$place/target/release/"
for own in xtask contract; do
  find "$place/target/release" -depth -name "*$own-*" -exec rm -rf {} +
done

export CARGO_TARGET_DIR="$place/target" POSECUT_CONTRACT_ONLY=echo
cd "$copy"
# The same targets as for all tests, because Cargo chooses the features of other people's crates by what it builds: for other targets, it
# would build them anew.
cargo build --release --offline --quiet --workspace --bins --test contract
cargo test --release --offline --quiet --workspace --test contract -- table:: standard_output:: threads::
programs=$CARGO_TARGET_DIR/release
"$programs/posecut" help | grep -q '^  echo  *Reject' || { echo 'check-new-stage: posecut help does not list it'; exit 1; }
"$programs/posecut-experiment" stages --programs "$programs" | grep -q '^echo' ||
  { echo 'check-new-stage: experiments do not find it'; exit 1; }
make --no-print-directory -n table ECHO=./mine 2>&1 | grep -q -- '--program echo=./mine' ||
  { echo 'check-new-stage: the Makefile does not swap it'; exit 1; }
echo 'a new stage changes no other crate'
